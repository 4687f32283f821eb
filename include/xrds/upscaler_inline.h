#pragma once

#include <string>

#include "xrds/layers_call.h"
#include "xrds/upscaler.h"
#include "xrds/xrds_report.h"

namespace xrds {
namespace call {

inline XrdsUpscalerOptions options(const Upscaler::Options& given) {
  if (given.exposure && !Upscaler::isExposure(*given.exposure))
    throw InvalidArgument("An exposure of " + std::to_string(*given.exposure) +
                          " was given, expected a number between 1e-30 and 1e30.");
  XrdsUpscalerOptions asked = xrdsUpscalerOptionsDefault();
  given.tiles.fill(asked);
  asked.fp16 = given.fp16;
  asked.exposure = given.exposure.value_or(0);
  asked.ensemble = given.ensemble;
  asked.skipBound = given.skip.bound;
  asked.keepUnchanged = given.skip.keepUnchanged;
  asked.tune = given.tune == Upscaler::Tune::now     ? XRDS_TUNE_NOW
               : given.tune == Upscaler::Tune::never ? XRDS_TUNE_NEVER
                                                     : XRDS_TUNE_AUTO;
  asked.multiplyAddsPerSubmission = given.multiplyAddsPerSubmission;
  asked.profile = given.profile;
  const auto handleOf = [](const Model* model) { return model ? model->handle() : nullptr; };
  asked.denoiser = handleOf(given.denoisers.colour);
  asked.albedoDenoiser = handleOf(given.denoisers.albedo);
  asked.normalDenoiser = handleOf(given.denoisers.normal);
  asked.denoisedColour = given.denoisedColour;
  asked.separateDenoisers = given.denoisers.separate;
  asked.levelColour = given.denoisers.level;
  return asked;
}

template <class Report>
Upscaler::ProfileRow profileRow(const Report& row) {
  return {row.label, row.program, row.multiplyAdds, row.bytes, row.microseconds};
}

}  // namespace call

inline Upscaler::Upscaler(Device& device, const Model& model, uint32_t width, uint32_t height, const Options& options)
    : listener_(device.listener_),
      inputs_(model.auxiliaryInputs()),
      width_(model.scale() * width),
      height_(model.scale() * height) {
  XrdsUpscalerOptions asked = call::options(options);
  call::Heard tuning(options.onTuning);
  if (options.onTuning) asked.tuning = decltype(tuning)::template hear<double>;
  asked.tuningUser = tuning.user();
  XrdsUpscaler* made = nullptr;
  const XrdsResult result = xrdsCreateUpscaler(device.handle(), model.handle(), width, height, &asked, &made);
  handle_.reset(made);
  tuning.finish(XRDS_OK);
  device.finish(result);
  auto tiles = call::sized<XrdsTiling>();
  call::check(xrdsGetTiling(handle(), &tiles));
  tiling_ = Tiling::of(tiles);
}

inline bool Upscaler::run(const PixelView& colour, std::span<const PixelView> auxiliary, std::span<float> output,
                          const Progress& progress) {
  return run(colour, auxiliary, output, std::span<const LayerSet>(), progress);
}

inline bool Upscaler::run(const PixelView& colour, std::span<const PixelView> auxiliary, std::span<float> output,
                          std::span<const LayerSet> layers, const Progress& progress) {
  const XrdsImage low = call::image(colour, "colour"), picture = call::output("output", output, width_, height_);
  const std::vector<XrdsImage> images = call::images(auxiliary, inputs_);
  std::vector<call::Layers> kept;
  kept.reserve(layers.size());
  std::vector<XrdsLayerSet> sets;
  std::vector<XrdsLayerReport> reports(layers.size(), call::sized<XrdsLayerReport>());
  for (const LayerSet& set : layers) sets.push_back(kept.emplace_back(set, width_, height_).given());
  call::Heard heard(progress);
  const XrdsResult result =
      xrdsUpscaleLayers(handle(), &low, images.data(), static_cast<uint32_t>(images.size()), &picture, sets.data(),
                        static_cast<uint32_t>(sets.size()), reports.data(),
                        progress ? decltype(heard)::template hear<double> : nullptr, heard.user());
  heard.finish(XRDS_OK);
  finish(result == XRDS_CANCELLED ? XRDS_OK : result);
  if (result != XRDS_OK) return false;
  layerReports_.clear();
  for (const XrdsLayerReport& report : reports)
    layerReports_.push_back({report.share, report.raisedColours, report.unshared});
  return true;
}

inline std::string Upscaler::kernelFamily(const std::string& family, uint32_t width, uint32_t height) {
  return family == "lane" && uint64_t{width} * height <= kSmallFrame ? "plain" : family;
}

inline bool Upscaler::paysToTune(const Device& device, const Model& model, uint32_t width, uint32_t height, bool fp16) {
  int32_t pays = 0;
  call::check(xrdsPaysToTune(device.handle(), model.handle(), width, height, fp16, &pays));
  return pays != 0;
}

inline Upscaler::Repairs Upscaler::repairs() const {
  auto found = call::sized<XrdsRepairs>();
  call::check(xrdsGetRepairs(handle(), &found));
  return {found.colour, found.auxiliary, found.output};
}

inline SkipMap Upscaler::skipMap() const {
  auto found = call::sized<XrdsSkipMap>();
  call::check(xrdsGetSkipMap(handle(), &found, nullptr, 0));
  std::vector<uint8_t> windows(size_t{found.columns} * found.rows);
  call::check(xrdsGetSkipMap(handle(), &found, windows.data(), windows.size()));
  SkipMap map{.side = found.side, .columns = found.columns, .rows = found.rows, .work = found.work};
  for (const uint8_t window : windows) map.windows.push_back(static_cast<SkipMap::Window>(window));
  return map;
}

inline std::vector<Upscaler::ProfileRow> Upscaler::profile() const {
  std::vector<ProfileRow> rows;
  const auto add = [&](const XrdsProfileRow* row) { rows.push_back(call::profileRow(*row)); };
  call::Heard heard(add);
  heard.finish(xrdsGetProfile(handle(), decltype(heard)::template listen<const XrdsProfileRow*>, heard.user()));
  return rows;
}

inline std::vector<Upscaler::CheckRow> Upscaler::check(Device& device, const Model& model, const PixelView& colour,
                                                       std::span<const PixelView> auxiliary, const Options& options) {
  const XrdsUpscalerOptions asked = call::options(options);
  const XrdsImage low = call::image(colour, "colour");
  const std::vector<XrdsImage> images = call::images(auxiliary, model.auxiliaryInputs());
  std::vector<CheckRow> rows;
  const auto add = [&](const XrdsCheckRow* row) {
    rows.push_back({row->label, row->relativeRms, row->finite != 0, row->withinBound != 0});
  };
  call::Heard heard(add);
  const XrdsResult result =
      xrdsCheckFrame(device.handle(), model.handle(), &low, images.data(), static_cast<uint32_t>(images.size()), &asked,
                     decltype(heard)::template listen<const XrdsCheckRow*>, heard.user());
  heard.finish(XRDS_OK);
  device.finish(result);
  return rows;
}

}  // namespace xrds
