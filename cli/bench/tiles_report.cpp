#include "cli/bench/tiles_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/listed.h"
#include "cli/json_text.h"
#include "cli/table.h"

namespace xrds {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::pair<const char*, const char*> kDefinitions[] = {
    {"halo", "low-resolution pixels around each tile"},
    {"relativeRms",
     "RMS of the difference to the picture of the whole frame over the RMS of that, both as log(1 + exposure "
     "radiance)"},
    {"psnrChange", "PSNR against the reference less that of the whole frame, dB"},
    {"step", "the largest change of the difference of the sRGB pictures between two neighbouring pixels, in 255ths"},
    {"worst", "of each number by itself: the largest, of psnrChange the least"},
};

Json jsonOf(const TileError& error) {
  return {{"relativeRms", error.relativeRms}, {"psnrChange", error.psnr}, {"step", error.step}};
}

Json jsonOf(const TilesReport& report, const HaloErrors& errors) {
  Json json{{"halo", errors.halo}, {"mean", jsonOf(errors.mean())}, {"worst", jsonOf(errors.worst())}};
  for (size_t i = 0; i < errors.scenes.size(); ++i) json["scenes"][report.sceneNames[i]] = jsonOf(errors.scenes[i]);
  return json;
}

Row rowOf(const HaloErrors& errors) {
  const TileError mean = errors.mean(), worst = errors.worst();
  return {std::to_string(errors.halo), text("%.2e", mean.relativeRms), text("%.2e", worst.relativeRms),
          text("%+.4f", mean.psnr),    text("%+.4f", worst.psnr),      text("%.2f", worst.step)};
}

}  // namespace

TileError HaloErrors::mean() const {
  TileError mean;
  for (const TileError& error : scenes) {
    mean.relativeRms += error.relativeRms / static_cast<double>(scenes.size());
    mean.psnr += error.psnr / static_cast<double>(scenes.size());
    mean.step += error.step / static_cast<double>(scenes.size());
  }
  return mean;
}

TileError HaloErrors::worst() const {
  TileError worst = scenes.empty() ? TileError{} : scenes.front();
  for (const TileError& error : scenes) {
    worst.relativeRms = std::max(worst.relativeRms, error.relativeRms);
    worst.psnr = std::min(worst.psnr, error.psnr);
    worst.step = std::max(worst.step, error.step);
  }
  return worst;
}

std::string plainText(const TilesReport& report) {
  std::vector<Row> table{{"halo", "RMS, mean", "RMS, worst", "PSNR, mean", "PSNR, worst", "largest step"}};
  for (const HaloErrors& errors : report.halos) table.push_back(rowOf(errors));
  return report.run.model + ", " + report.run.precision + ", " + counted(report.sceneNames.size(), "scene") + " of " +
         report.run.folder + ", " + std::to_string(report.columns) + " x " + std::to_string(report.rows) + " tiles\n" +
         markdown(table);
}

std::string jsonText(const TilesReport& report) {
  Json json = jsonOf(report.run, kDefinitions);
  json["columns"] = report.columns;
  json["rows"] = report.rows;
  json["halos"] = Json::array();
  for (const HaloErrors& errors : report.halos) json["halos"].push_back(jsonOf(report, errors));
  return textOf(json);
}

}  // namespace xrds
