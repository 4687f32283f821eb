#include "cli/upscale_frame.h"

#include "app/timer.h"
#include "app/upscale_frame.h"
#include "cli/progress.h"
#include "cli/table.h"
#include "cli/warnings.h"
#include "xrds/tuning.h"

namespace xrds {
namespace {

// Tuning takes minutes: a frame that the memory cannot hold is refused before.
void requireRoom(const Device& device, const UpscaleInput& input, const UpscaleOptions& options) {
  const Upscaler::Options asked = options.upscaler();
  const Device::Description about = device.description();
  TileOptions tiles = asked.tiles;
  if (tiles.memoryBytes == 0) tiles.memoryBytes = about.memoryBytes / 4 * 3;
  const Model& model = input.opened.model;
  model.tiling(model.scale() * input.frame.width(), model.scale() * input.frame.height(), asked.fp16, tiles,
               about.kernelFamily);
}

Tuning::Report tuned(Device& device, const UpscaleInput& input, const UpscaleOptions& options) {
  const auto& [opened, frame] = input;
  ProgressBar bar(options.quiet);
  return untilInterrupted([&] {
    return Tuning::run(device, opened.model, frame.width(), frame.height(),
                       {.fp16 = options.precision == kFp16,
                        .label = opened.name(),
                        .progress = [&](double share, const std::string&) { return bar.update(share); }});
  });
}

}  // namespace

void tuneFirst(Device& device, const UpscaleInput& input, const UpscaleOptions& options) {
  const auto& [opened, frame] = input;
  const bool fp16 = options.precision == kFp16;
  if (options.tune == "never" ||
      (options.tune == "auto" && !Upscaler::paysToTune(device, opened.model, frame.width(), frame.height(), fp16)))
    return;
  if (Tuning::known(device, opened.model, frame.width(), frame.height(), fp16)) return;
  requireRoom(device, input, options);
  if (!options.quiet) std::fputs("xrds: finding the fastest kernels of this device, kept for the next time\n", stderr);
  const Tuning::Report report = tuned(device, input, options);
  if (!report.unkept.empty()) printWarnings({report.unkept + "."});
}

Upscaled upscaledBy(Upscaler& upscaler, const Model& model, const Frame& frame, const Upscaler::Progress& progress) {
  const int scale = static_cast<int>(model.scale());
  Upscaled result{Image(frame.colour().width * scale, frame.colour().height * scale, 3)};
  const Timer timer;
  if (frame.layers()) {
    result.layers = frame.layers()->room(scale);
    upscaler.run(viewOf(frame.colour()), inputsOf(model, frame), result.colour.pixels,
                 frame.layers()->sets(result.layers), progress);
    result.layers.reports = frame.layers()->reports(upscaler.layerReports());
  } else {
    upscaleFrame(upscaler, model, frame, result.colour.pixels, progress);
  }
  stopIfInterrupted();
  result.seconds = timer.seconds();
  result.deviceBytes = upscaler.deviceBytes();
  result.exposure = upscaler.exposure();
  result.tiling = upscaler.tiling();
  result.skipped = upscaler.skipMap();
  result.profile = upscaler.profile();
  result.brokenPixels = upscaler.repairs().output;
  return result;
}

std::vector<std::string> warningsOf(const Upscaled& result, const Frame& frame, const UpscaleOptions& options) {
  std::vector<std::string> warnings;
  if (frame.layers()) warnings = frame.layers()->warnings(result.layers);
  if (result.brokenPixels == 0) return warnings;
  warnings.push_back("the network gave " + std::to_string(result.brokenPixels) +
                     " pixels that were not finite: they show the base image without it" +
                     (options.precision == kFp16 ? "; --precision fp32 has a larger range." : "."));
  return warnings;
}

void writePicture(const std::filesystem::path& path, const Frame& frame, const Image& image,
                  const UpscaledLayers& layers, const ExrOutput& output) {
  if (frame.layers())
    writeExr(path, frame.layers()->planes(image, layers, output.pixelType), output);
  else
    writeExr(path, image, output);
}

/// What the picture depends on, for the file's metadata.
std::string optionsOf(const UpscaleOptions& options, const Frame& frame, float exposure) {
  std::string words = "precision=" + options.precision + text(" exposure=%.6g", exposure) +
                      (options.exposure == "auto" ? " (auto)" : "");
  if (frame.merged()) words += text(" merged=%.3g", frame.merged()->share);
  if (options.ensemble > 1) words += " ensemble=" + std::to_string(options.ensemble);
  if (options.skip != "off") words += " skip=" + options.skip;
  if (options.wrap) words += " wrap";
  return words;
}

ExrOutput outputOf(const UpscaleOptions& options, const OpenedModel& opened, const Frame& frame, float exposure) {
  ExrOutput output = frame.output(static_cast<int>(opened.model.scale()));
  output.texts["xrds:version"] = XRDS_VERSION;
  output.texts["xrds:model"] = opened.name() + " " + opened.model.hash();
  output.texts["xrds:options"] = optionsOf(options, frame, exposure);
  if (!frame.denoisedBy().empty()) output.texts["xrds:denoiser"] = frame.denoisedBy();
  output.pixelType = options.half ? ExrPixelType::kHalf : ExrPixelType::kFloat;
  return output;
}

}  // namespace xrds
