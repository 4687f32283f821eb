#include "advice/ways.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "xrds/error.h"

namespace xrds {
namespace {

Way wayOf(const nlohmann::json& json) {
  const auto& coefficients = json.at("coefficients");
  Way way{.name = json.at("name"),
          .model = json.at("model"),
          .scale = json.at("scale"),
          .guides = json.at("guides") == "free" ? Guides::free : Guides::rendered,
          .merges = json.at("merges"),
          .denoisesFirst = json.at("denoisesFirst"),
          .takesFullColour = json.at("takesFullColour"),
          .ratios = json.at("ratios"),
          .constant = coefficients.at("constant"),
          .perNoise = coefficients.at("noise"),
          .perDetail = coefficients.at("detail"),
          .perGuideNoise = coefficients.at("guideNoise"),
          .leastNoise = json.at("noise").at(0),
          .mostNoise = json.at("noise").at(1),
          .spread = json.at("spread")};
  if (way.scale < 1 || (way.scale == 1 && way.merges))
    throw Error("Way '" + way.name + "' of scale " + std::to_string(way.scale) + " makes no sense.");
  return way;
}

}  // namespace

double Way::noiseLeft(const SceneFeatures& scene, RenderSamples samples) const {
  double count = scale == 1 ? samples.full : samples.low;
  if (merges) count += static_cast<double>(scale * scale) * samples.full;
  return scene.noise - std::log2(count);
}

double Way::predictedPsnr(const SceneFeatures& scene, RenderSamples samples) const {
  const double guideNoise = guides == Guides::free ? 0 : scene.guideNoise - std::log2(samples.full);
  return constant + perNoise * noiseLeft(scene, samples) + perDetail * scene.detail + perGuideNoise * guideNoise;
}

std::vector<Way> readWays(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw Error("Cannot read '" + file.string() + "'.");
  try {
    const nlohmann::json json = nlohmann::json::parse(stream);
    std::vector<Way> ways;
    for (const auto& way : json.at("ways")) ways.push_back(wayOf(way));
    return ways;
  } catch (const nlohmann::json::exception& error) {
    throw Error("'" + file.string() + "' does not tell the ways to a picture: " + error.what() + ".");
  }
}

}  // namespace xrds
