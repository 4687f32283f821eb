#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>

#include "app/failing_with.h"
#include "app/network_options.h"
#include "app/skip_bound.h"
#include "app/skip_map.h"
#include "app/timer.h"
#include "cli/alpha.h"
#include "cli/commands.h"
#include "cli/device_choice.h"
#include "cli/first_denoiser.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/sequence_run.h"
#include "cli/upscale_frame.h"
#include "cli/upscale_report.h"
#include "cli/upscale_sequence.h"
#include "cli/warnings.h"
#include "image/png_write.h"
#include "xrds/path_text.h"

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

// Where that takes the device: the upscaler is there after it if the networks go along with the frame.
void denoiseFirst(Device& device, const Model& model, Frame& frame, FirstDenoiser& denoiser,
                  std::optional<Upscaler>& upscaler) {
  if (!denoiser.takes(frame)) return;
  failingWith(ExitCode::device, [&] {
    if (denoiser.goesAlong(frame)) denoiser.prepare(upscaler, device, model, frame);
    denoiser.denoise(device, frame);
  });
}

Upscaled compute(Upscaler& upscaler, const Model& model, const Frame& frame, const UpscaleOptions& options) {
  stopIfInterrupted();
  Upscaled result;
  {
    ProgressBar bar(options.quiet);
    result = upscaledBy(upscaler, model, frame, [&](double share) { return bar.update(share); });
  }
  if (options.profile && !options.quiet) printProfile(result.profile);
  printWarnings(warningsOf(result, frame, options));
  return result;
}

void writeResult(const UpscaleOptions& options, const UpscaleInput& input, const Upscaled& result,
                 const std::optional<Image>& alpha) {
  failingWith(ExitCode::output, [&] {
    const ExrOutput output = outputOf(options, input.opened, input.frame, result.exposure);
    writePicture(pathOf(options.output), input.frame, alpha ? withAlpha(result.colour, *alpha) : result.colour,
                 result.layers, output);
    if (!options.preview.empty()) writePng(pathOf(options.preview), result.colour);
    if (!options.skipMap.empty()) writeSkipMap(pathOf(options.skipMap), result.colour, result.skipped);
  });
}

/// All that is known before a device is needed.
struct Task {
  const UpscaleOptions& options;
  UpscaleInput& input;
  const std::optional<Image>& reference;
  Timer whole;
};

void upscaleOn(Device& device, const Task& task) {
  const auto& [options, input, reference, whole] = task;
  auto& [opened, frame] = input;
  const int scale = static_cast<int>(opened.model.scale());
  tuneFirst(device, input, options);
  std::optional<ProgressBar> bar;
  FirstDenoiser denoiser(options, FirstDenoiser::Frames::one, [&](double share) {
    if (!bar) bar.emplace(options.quiet);
    return bar->update(share);
  });
  std::optional<Upscaler> upscaler;
  denoiseFirst(device, opened.model, frame, denoiser, upscaler);
  bar.reset();
  std::optional<EndsAtOnce> endsAtOnce(std::in_place);
  std::vector<Upscaler::CheckRow> checks;
  if (options.check) checks = runCheck(device, opened.model, frame, options);
  if (!upscaler) upscaler.emplace(device, opened.model, frame.width(), frame.height(), options.upscaler());
  Upscaled result = compute(*upscaler, opened.model, frame, options);
  upscaler.reset();
  result.seconds += denoiser.seconds();
  result.deviceBytes = std::max(result.deviceBytes, denoiser.deviceBytes());
  result.checks = std::move(checks);
  std::optional<Image> alpha;
  if (frame.alpha()) {
    AlphaUpscaler bicubic(device, frame.width(), frame.height(), opened.model.scale(), options.upscaler().tiles);
    alpha = upscaleAlpha(bicubic, *frame.alpha(), scale);
  }
  endsAtOnce.reset();
  writeResult(options, input, result, alpha);
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
  requirePanorama(options.wrap, options.ensemble, parseSkip(options.skip));
  requireLayersPossible(options);
  if (isSequence(options)) return upscaleSequence(options);
  requireOutputs(options);
  sortInputs(options);
  UpscaleInput input = openInput(options);
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
  CLI::App* verb = app.add_subcommand("upscale", "Upscale one frame, or a sequence of frames");
  addUpscaleOptions(*verb, *options);
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
