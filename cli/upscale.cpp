#include <cstdio>
#include <memory>

#include "app/failing_with.h"
#include "app/skip_map.h"
#include "cli/alpha.h"
#include "cli/commands.h"
#include "cli/device_choice.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/timer.h"
#include "cli/upscale_report.h"
#include "cli/warnings.h"
#include "image/png_write.h"
#include "xrds/tuning.h"

namespace xrds {
namespace {

std::vector<Upscaler::CheckRow> runCheck(Device& device, const Model& model, const Frame& frame,
                                         const UpscaleOptions& options) {
  auto rows = failingWith(ExitCode::device, [&] { return checkOnCrop(device, model, frame, options.upscaler()); });
  if (!options.quiet) printCheck(rows);
  if (const int divergent = firstDivergent(rows); divergent >= 0)
    throw Failure{ExitCode::differs,
                  "The device diverges from the reference, first at operator '" + rows[divergent].label + "'."};
  return rows;
}

// Before anything else, and not while an interrupt ends the process at once: what is being tried would be struck off.
void tuneFirst(Device& device, const UpscaleInput& input, const UpscaleOptions& options) {
  const auto& [opened, frame] = input;
  const bool fp16 = options.precision == kFp16;
  if (options.tune == "never" ||
      (options.tune == "auto" && !Upscaler::paysToTune(device, opened.model, frame.width(), frame.height(), fp16)))
    return;
  if (Tuning::known(device, opened.model, frame.width(), frame.height(), fp16)) return;
  if (!options.quiet) std::fputs("xrds: finding the fastest kernels of this device, kept for the next time\n", stderr);
  ProgressBar bar(options.quiet);
  try {
    Tuning::run(device, opened.model, frame.width(), frame.height(),
                {.fp16 = fp16, .label = opened.name(), .progress = [&](double share, const std::string&) {
                   return bar.update(share);
                 }});
  } catch (const Cancelled&) {
    stopIfInterrupted();
    throw;
  }
}

Upscaled compute(Device& device, const Model& model, const Frame& frame, const UpscaleOptions& options) {
  const int scale = static_cast<int>(model.scale());
  Upscaled result{Image(frame.colour().width * scale, frame.colour().height * scale, 3)};
  Upscaler upscaler(device, model, frame.width(), frame.height(), options.upscaler());
  stopIfInterrupted();
  const Timer timer;
  {
    ProgressBar bar(options.quiet);
    const auto auxiliary = inputsOf(model, frame);
    upscaler.run(viewOf(frame.colour()), auxiliary, result.colour.pixels,
                 [&](double share) { return bar.update(share); });
  }
  stopIfInterrupted();
  result.seconds = timer.seconds();
  result.deviceBytes = upscaler.deviceBytes();
  result.exposure = upscaler.exposure();
  result.tiling = upscaler.tiling();
  result.skipped = upscaler.skipMap();
  result.profile = upscaler.profile();
  result.brokenPixels = upscaler.repairs().output;
  if (options.profile && !options.quiet) printProfile(result.profile);
  if (result.brokenPixels > 0)
    printWarnings({"the network gave " + std::to_string(result.brokenPixels) +
                   " pixels that were not finite: they show the base image without it" +
                   (options.precision == kFp16 ? "; --precision fp32 has a larger range." : ".")});
  return result;
}

void writeResult(const UpscaleOptions& options, const Frame& frame, const OpenedModel& opened, const Upscaled& result,
                 const std::optional<Image>& alpha) {
  char exposure[32];
  std::snprintf(exposure, sizeof exposure, "%.6g", result.exposure);
  failingWith(ExitCode::output, [&] {
    ExrOutput output = frame.output(static_cast<int>(opened.model.scale()));
    output.texts["xrds:version"] = XRDS_VERSION;
    output.texts["xrds:model"] = opened.name() + " " + opened.model.hash();
    output.texts["xrds:options"] =
        "precision=" + options.precision + " exposure=" + exposure + (options.exposure == "auto" ? " (auto)" : "");
    if (options.ensemble > 1) output.texts["xrds:options"] += " ensemble=" + std::to_string(options.ensemble);
    output.pixelType = options.half ? ExrPixelType::kHalf : ExrPixelType::kFloat;
    writeExr(options.output, alpha ? withAlpha(result.colour, *alpha) : result.colour, output);
    if (!options.preview.empty()) writePng(options.preview, result.colour);
    if (!options.skipMap.empty()) writeSkipMap(options.skipMap, result.colour, result.skipped);
  });
}

/// All that is known before a device is needed.
struct Task {
  const UpscaleOptions& options;
  const UpscaleInput& input;
  const std::optional<Image>& reference;
  Timer whole;
};

void upscaleOn(Device& device, const Task& task) {
  const auto& [options, input, reference, whole] = task;
  const auto& [opened, frame] = input;
  const int scale = static_cast<int>(opened.model.scale());
  tuneFirst(device, input, options);
  std::optional<EndsAtOnce> endsAtOnce(std::in_place);
  std::vector<Upscaler::CheckRow> checks;
  if (options.check) checks = runCheck(device, opened.model, frame, options);
  Upscaled result = compute(device, opened.model, frame, options);
  result.checks = std::move(checks);
  std::optional<Image> alpha;
  if (frame.alpha()) alpha = upscaleAlpha(device, *frame.alpha(), scale, options.upscaler().tiles);
  endsAtOnce.reset();
  writeResult(options, frame, opened, result, alpha);
  result.secondsInAll = whole.seconds();
  if (!options.quiet) std::fputs(upscaleText(options, input, device.description(), result).c_str(), stdout);
  if (!options.sideBySide.empty()) writeSideBySide(device, frame, result.colour, reference, options.sideBySide);
  if (reference && !(options.quiet && options.json.empty()))
    result.measured = measureWithBaselines(device, frame, result.colour, *reference);
  if (!options.quiet) printMeasured(result.measured);
  if (!options.json.empty())
    failingWith(ExitCode::output,
                [&] { writeText(options.json, upscaleJson(options, input, device.description(), result)); });
}

void run(UpscaleOptions options) {
  const Timer whole;
  requireOutputs(options);
  if (options.wrap && options.ensemble == 8)
    throw Failure{ExitCode::usage, "--ensemble 8 and --wrap exclude each other: 4 leaves out the diagonal."};
  sortInputs(options);
  const UpscaleInput input = openInput(options);
  const Image& colour = input.frame.colour();
  const int scale = static_cast<int>(input.opened.model.scale());
  std::optional<Image> reference;
  if (!options.reference.empty())
    reference = failingWith(
        ExitCode::input, [&] { return readReference(options.reference, scale * colour.width, scale * colour.height); });
  printWarnings(input.frame.warnings());
  stopIfInterrupted();
  const Task task{options, input, reference, whole};
  onDevice(options.device, options.quiet, [&](Device& device) { upscaleOn(device, task); });
}

}  // namespace

void addUpscale(CLI::App& app) {
  const auto options = std::make_shared<UpscaleOptions>();
  CLI::App* verb = app.add_subcommand("upscale", "Upscale one frame");
  addUpscaleOptions(*verb, *options);
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
