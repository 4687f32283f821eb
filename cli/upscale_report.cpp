#include "cli/upscale_report.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/listed.h"
#include "app/skip_bound.h"
#include "cli/device_json.h"
#include "cli/json_text.h"
#include "cli/metric_columns.h"
#include "cli/table.h"

namespace xrds {
namespace {

using Json = nlohmann::ordered_json;

// ", 61 % of the windows skipped", or nothing if none may be.
std::string skipText(const UpscaleOptions& options, const SkipMap& map) {
  if (parseSkip(options.skip) == 0) return "";
  return text(", %.0f %% of the windows skipped", 100 * map.share(SkipMap::Window::interpolated));
}

// " in 6 tiles", or nothing for a frame in one piece.
std::string tilesText(const Tiling& tiling) {
  const uint32_t count = tiling.columns * tiling.rows;
  return count == 1 ? "" : " in " + std::to_string(count) + " tiles";
}

Json filesOf(const UpscaleOptions& options) {
  const auto nameOrNull = [](const std::string& file) { return file.empty() ? Json() : Json(file); };
  return {{"colour", options.color},
          {"auxiliary", nameOrNull(options.aux)},
          {"reference", nameOrNull(options.reference)},
          {"output", options.output}};
}

Json jsonOf(const Upscaler::CheckRow& row) {
  return {{"operator", row.label},
          {"relativeRms", row.relativeRms},
          {"finite", row.finite},
          {"withinBound", row.withinBound}};
}

Json jsonOf(const Upscaler::ProfileRow& row) {
  return {{"operator", row.label},
          {"program", row.program},
          {"multiplyAdds", row.multiplyAdds},
          {"bytes", row.bytes},
          {"microseconds", row.microseconds}};
}

Json jsonOf(const std::optional<MergedColour>& merged) {
  if (!merged) return {};
  Json json{{"layer", merged->layer}, {"share", merged->share}, {"source", merged->source}};
  if (merged->samples) json["samples"] = {merged->samples->low, merged->samples->full};
  return json;
}

Json jsonOf(const std::optional<FrameLayers>& layers, const UpscaledLayers& upscaled) {
  if (!layers) return {};
  const LayerList& list = layers->list();
  Json json{{"upscaled", list.upscaled}, {"copied", list.copied}, {"leftOut", list.leftOut}, {"merged", list.merged}};
  json["sets"] = Json::array();
  for (const LayerReport& set : upscaled.reports)
    json["sets"].push_back(
        {{"share", set.share}, {"raisedColours", set.raisedColours}, {"unsharedPixels", set.unshared}});
  return json;
}

Json jsonOf(const MeasuredImage& measured) {
  Json json{{"name", measured.name}};
  json.update(jsonOf(measured.metrics));
  return json;
}

template <class Row>
Json listOf(const std::vector<Row>& rows) {
  Json list = Json::array();
  for (const Row& row : rows) list.push_back(jsonOf(row));
  return list;
}

}  // namespace

std::string layersText(const LayerList& layers) {
  std::string text = "Layers of light" + std::string(layers.merged ? ", merged with those of AUX" : "") + ": " +
                     listed(layers.upscaled) + ".\n";
  if (!layers.copied.empty()) text += "Copied: " + listed(layers.copied) + ".\n";
  if (!layers.leftOut.empty()) text += "Left out: " + listed(layers.leftOut) + ".\n";
  return text;
}

std::string upscaleText(const UpscaleOptions& options, const UpscaleInput& input, const Device::Description& device,
                        const Upscaled& result) {
  return options.output + ": " + std::to_string(result.colour.width) + " x " + std::to_string(result.colour.height) +
         tilesText(result.tiling) + skipText(options, result.skipped) + ", model " + input.opened.name() + " (" +
         options.precision + "), exposure " + text("%.4g", result.exposure) + ", on " + device.name + ": " +
         text("%.2f s of compute, ", result.seconds) +
         text("%.1f MB of device memory, ", static_cast<double>(result.deviceBytes) / 1e6) +
         text("%.2f s in all", result.secondsInAll) + "\n" +
         (input.frame.merged() ? describe(*input.frame.merged()) + "\n" : "") +
         (input.frame.denoisedBy().empty() ? "" : "Denoised first, by " + input.frame.denoisedBy() + ".\n") +
         (input.frame.layers() ? layersText(input.frame.layers()->list()) : "");
}

std::string upscaleJson(const UpscaleOptions& options, const UpscaleInput& input, const Device::Description& device,
                        const Upscaled& result) {
  Json json{{"version", XRDS_VERSION}, {"files", filesOf(options)}};
  json["width"] = result.colour.width;
  json["height"] = result.colour.height;
  json["scale"] = input.opened.model.scale();
  json["model"] = {{"name", input.opened.name()}, {"hash", input.opened.model.hash()}};
  json["device"] = jsonOf(device);
  json["precision"] = options.precision;
  json["ensemble"] = options.ensemble;
  json["exposure"] = result.exposure;
  json["mergedColour"] = jsonOf(input.frame.merged());
  json["denoisedBy"] = input.frame.denoisedBy().empty() ? Json() : Json(input.frame.denoisedBy());
  json["computeSeconds"] = result.seconds;
  json["seconds"] = result.secondsInAll;
  json["deviceBytes"] = result.deviceBytes;
  json["tiles"] = {{"columns", result.tiling.columns}, {"rows", result.tiling.rows}, {"halo", result.tiling.halo}};
  json["skip"] = {{"bound", parseSkip(options.skip)},
                  {"share", result.skipped.share(SkipMap::Window::interpolated)},
                  {"work", result.skipped.work}};
  json["repairedPixels"] = {{"input", input.frame.repairedPixels()}, {"output", result.brokenPixels}};
  json["layers"] = jsonOf(input.frame.layers(), result.layers);
  json["methods"] = listOf(result.measured);
  json["checks"] = listOf(result.checks);
  json["profile"] = listOf(result.profile);
  return textOf(json);
}

}  // namespace xrds
