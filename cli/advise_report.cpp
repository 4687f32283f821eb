#include "cli/advise_report.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/json_text.h"
#include "cli/table.h"

namespace xrds {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::pair<const char*, const char*> kDefinitions[] = {
    {"noise", "log2 of the variance of one sample a pixel, of the sRGB picture"},
    {"detail", "log2 of the mean product of the differences between neighbours in both renders, at low resolution"},
    {"guideNoise",
     "log2 of the mean square that a median of 3 x 3 takes from albedo and normal, for one sample a pixel"},
    {"perSample", "seconds of one sample of one pixel"},
    {"start", "seconds of a render before its first sample"},
    {"afterSeconds", "predicted seconds of denoiser and network on this device"},
    {"psnr", "predicted, dB"},
    {"spread", "root mean square of the prediction's errors for scenes that were left out of it, dB"},
};

std::string size(const Advice& advice, int scale) {
  return std::to_string(advice.width / scale) + " x " + std::to_string(advice.height / scale);
}

std::string samplesText(double samples) { return samples == 0 ? "" : text("%g", samples); }

Row rowOf(const Advice& advice, const Plan& plan) {
  return {plan.way.name,
          plan.samples.low == 0 ? "" : samplesText(plan.samples.low) + " at " + size(advice, plan.way.scale),
          samplesText(plan.samples.full),
          text("%.1f", plan.renderSeconds),
          text("%.1f", plan.afterSeconds),
          text("%.1f", plan.psnr),
          text("%.1f", plan.way.spread)};
}

std::string denoiseCommand(const Way& way, bool isImported) {
  const bool ownGuides = way.guides == Guides::rendered;
  if (!isImported)
    return std::string("denoise it with Open Image Denoise and ") +
           (ownGuides ? "its albedo and normal" : "the albedo and normal of guides.exr");
  return ownGuides ? "xrds denoise full.exr -o out.exr" : "xrds denoise full.exr guides.exr -o out.exr --guides clean";
}

std::string upscaleCommand(const Way& way) {
  const bool ownGuides = way.guides == Guides::rendered;
  const char* files = way.scale > 1 ? "low.exr full.exr" : ownGuides ? "full.exr" : "full.exr guides.exr";
  std::string command = std::string("xrds upscale ") + files + " -o out.exr --model " + way.model;
  if (way.denoisesFirst) command += ownGuides ? " --denoise-first" : " --denoise-first --clean-guides";
  if (way.scale > 1 && !way.merges && ownGuides) command += " --aux-colour never";
  return command;
}

// The steps of a plan, one a line.
std::vector<std::string> stepsOf(const Advice& advice, const Plan& plan) {
  std::vector<std::string> steps;
  const auto samples = [](double count) { return text("%g", count) + (count == 1 ? " sample" : " samples"); };
  if (plan.samples.low > 0)
    steps.push_back("render " + size(advice, plan.way.scale) + " with " + samples(plan.samples.low) +
                    " a pixel: low.exr");
  if (plan.samples.full > 0)
    steps.push_back("render " + size(advice, 1) + " with " + samples(plan.samples.full) +
                    " a pixel, with albedo and normal: full.exr");
  if (plan.way.guides == Guides::free)
    steps.push_back("make clean albedo and normal of " + size(advice, 1) +
                    (plan.samples.full > 0 ? ": guides.exr" : ": full.exr"));
  steps.push_back(plan.way.model.empty() ? denoiseCommand(plan.way, advice.steps.denoiserIsImported)
                                         : upscaleCommand(plan.way));
  return steps;
}

Json jsonOf(const Advice& advice, const Plan& plan) {
  return {{"way", plan.way.name},
          {"model", plan.way.model},
          {"scale", plan.way.scale},
          {"samples", {{"low", plan.samples.low}, {"full", plan.samples.full}}},
          {"freeGuides", plan.way.guides == Guides::free},
          {"merge", plan.way.merges},
          {"denoiseFirst", plan.way.denoisesFirst},
          {"renderSeconds", plan.renderSeconds},
          {"afterSeconds", plan.afterSeconds},
          {"psnr", plan.psnr},
          {"spread", plan.way.spread},
          {"steps", stepsOf(advice, plan)}};
}

}  // namespace

std::string plainText(const Advice& advice) {
  const auto root = [](double logarithm) { return std::exp2(logarithm / 2); };
  std::string lines = "One sample a pixel has a noise of " + text("%.3f", root(advice.scene.noise)) +
                      " (root mean square, of the sRGB picture), albedo and normal of " +
                      text("%.3f", root(advice.scene.guideNoise)) + "; neighbours at low resolution differ by " +
                      text("%.3f", root(advice.scene.detail)) + ".\n";
  if (!advice.cost) return lines;
  lines +=
      "A render takes " + text("%.2f", advice.cost->start) + " s and, for each sample of " + size(advice, 1) +
      " pixels, " +
      text("%.2f", advice.cost->seconds(1, static_cast<size_t>(advice.width) * advice.height) - advice.cost->start) +
      " s.\n";
  if (!advice.steps.denoiser)
    lines +=
        "Open Image Denoise is not there, neither its networks (xrds import oidn) nor its library: ways with it are "
        "left out.\n";
  for (const int scale : advice.unfitScales)
    lines += size(advice, 1) + " pixels are no multiple of " + std::to_string(scale) +
             ": ways of that scale are left out.\n";
  std::vector<Row> rows{{"way", "low-resolution samples", "full", "render s", "then s", "PSNR dB", "+-"}};
  for (const Plan& plan : advice.plans) rows.push_back(rowOf(advice, plan));
  lines += "\nThe best plans, each better than all quicker ones, on " + advice.device + ":\n\n" + aligned(rows);
  if (!advice.chosen) return lines;
  lines += "\nAdvised, " + text("%.1f", advice.chosen->seconds()) + " s for " + text("%.1f", advice.chosen->psnr) +
           " dB, give or take " + text("%.1f", advice.chosen->way.spread) + ":\n";
  for (const std::string& step : stepsOf(advice, *advice.chosen)) lines += "  " + step + "\n";
  return lines;
}

std::string jsonText(const Advice& advice) {
  Json json{{"version", XRDS_VERSION}, {"low", advice.low},
            {"full", advice.full},     {"width", advice.width},
            {"height", advice.height}, {"samples", {{"low", advice.samples.low}, {"full", advice.samples.full}}}};
  for (const auto& [name, definition] : kDefinitions) json["definitions"][name] = definition;
  json["scene"] = {
      {"noise", advice.scene.noise}, {"detail", advice.scene.detail}, {"guideNoise", advice.scene.guideNoise}};
  if (advice.cost) {
    json["render"] = {{"start", advice.cost->start}, {"perSample", advice.cost->perSample}};
    json["device"] = advice.device;
    json["modelSeconds"] = advice.steps.models;
    json["denoiserSeconds"] = nullptr;
    if (advice.steps.denoiser) json["denoiserSeconds"] = *advice.steps.denoiser;
    json["plans"] = Json::array();
    for (const Plan& plan : advice.plans) json["plans"].push_back(jsonOf(advice, plan));
    json["advised"] = nullptr;
    if (advice.chosen) json["advised"] = jsonOf(advice, *advice.chosen);
  }
  return textOf(json);
}

}  // namespace xrds
