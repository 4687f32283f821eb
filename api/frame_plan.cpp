#include "api/frame_plan.h"

#include <algorithm>

#include "api/model.h"
#include "engine/kernel_family.h"
#include "frames/tile_choice.h"
#include "network/halo.h"
#include "tuning/tuned.h"
#include "tuning/tuner.h"
#include "tuning/tuning_lock.h"

namespace xrds {
namespace {

// Of a small frame on a CPU nearly all the time is the driver's, which optimizes kernels of written-out products.
KernelFamily familyFor(const Gpu& gpu, FrameShape frame) {
  if (gpu.hasAskedFamily()) return gpu.traits().family;
  return kernelFamilyOf(Upscaler::kernelFamily(nameOf(gpu.traits().family), frame.width, frame.height));
}

// Of frames that the device's own family makes, and that one graph can hold.
bool mayTune(const Gpu& gpu, const NetworkModel& model, FrameShape frame) {
  const bool isOneGraph = std::max(frame.width, frame.height) <= kMaxSide / model.config().scale;
  return isOneGraph && !gpu.hasAskedFamily() && familyFor(gpu, frame) == gpu.traits().family;
}

SparseOptions sparseOptions(const NetworkConfig& config, const Upscaler::Options& options) {
  if (options.tiles.wrap)
    throw InvalidArgument(
        "A panorama whose borders continue into each other is computed in full: skip nothing, or do not wrap.");
  // Around what is quiet one window is enough: bench/skip.md. Around what moved it is not.
  const uint32_t bounded =
      options.skip.keepUnchanged ? boundedHalo(config) : std::min(config.window, exactHalo(config));
  const uint32_t halo = options.tiles.halo.value_or(options.tiles.exact ? exactHalo(config) : bounded);
  return {.bound = options.skip.bound, .keepUnchanged = options.skip.keepUnchanged, .reach = halo, .halo = halo};
}

}  // namespace

SessionOptions sessionOptions(const Gpu& gpu, const NetworkModel& model, FrameShape frame,
                              const Upscaler::Options& options) {
  const Precision precision = options.fp16 ? Precision::fp16 : Precision::fp32;
  const KernelFamily family = familyFor(gpu, frame);
  KernelTable kernels;
  if (mayTune(gpu, model, frame)) kernels = tunedKernels(gpu, model, frame, precision).value_or(kernels);
  return {.precision = precision,
          .autoExposure = !options.exposure.has_value(),
          .timestamps = options.profile,
          .multiplyAddsPerSubmission = options.multiplyAddsPerSubmission,
          .family = family,
          .kernels = std::move(kernels)};
}

bool tuningPays(const Gpu& gpu, const NetworkModel& model, FrameShape frame, Precision precision) {
  const double pace = gpu.pace().mean;
  if (pace <= 0 || !mayTune(gpu, model, frame) || tunedKernels(gpu, model, frame, precision)) return false;
  const NodeCost work =
      cost(buildGraph(model.config(), frame, model.lookup(), fastOn(gpu.traits(), {.precision = precision})));
  const auto products = static_cast<double>(work.multiplyAdds + work.attentionMultiplyAdds);
  return products >= Upscaler::kSecondsThatPay * pace && !isTuningLocked(tuningFileOf(gpu).path());
}

uint64_t memoryOf(const Gpu& gpu, const TileOptions& options) {
  return options.memoryBytes ? options.memoryBytes : gpu.description().memoryBytes / 4 * 3;
}

Tiling tilingIn(uint64_t memory, const Gpu& gpu, const NetworkModel& model, FrameShape frame,
                const Upscaler::Options& options, const SessionOptions& of, uint32_t sharers) {
  DeviceTraits traits = gpu.traits();
  traits.family = *of.family;
  traits.memoryBytes = std::min(traits.memoryBytes, memory / sharers);
  return tilingOf(model, frame, options.fp16, options.tiles, {memory, traits, of.kernels, of.layers, sharers});
}

void tuneIfAsked(Gpu& gpu, const NetworkModel& model, FrameShape frame, const Upscaler::Options& options) {
  if (options.tune == Upscaler::Tune::never) return;
  if (options.tune == Upscaler::Tune::automatic && gpu.isShared()) return;  // who owns the queue wants it
  TuningOptions tuning{.precision = options.fp16 ? Precision::fp16 : Precision::fp32};
  if (options.tune == Upscaler::Tune::automatic && !tuningPays(gpu, model, frame, tuning.precision)) return;
  if (!mayTune(gpu, model, frame) || tunedKernels(gpu, model, frame, tuning.precision)) return;
  tilingIn(memoryOf(gpu, options.tiles), gpu, model, frame, options, sessionOptions(gpu, model, frame, options));
  if (options.onTuning) tuning.progress = [&](const TuningStep& step) { return options.onTuning(step.share); };
  tune(gpu, model, frame, tuning);
}

std::unique_ptr<FrameRunner> runnerOf(Gpu& gpu, const NetworkModel& model, FrameShape frame,
                                      const Upscaler::Options& options, const SessionOptions& of,
                                      const Tiling& tiling) {
  const bool skips = options.skip.bound > 0 || options.skip.keepUnchanged;
  if (tiling.columns * tiling.rows == 1 && !options.tiles.wrap && !skips) return wholeRunner(gpu, model, frame, of);
  const NetworkConfig& config = model.config();
  const auto tiles = cutFrame(frame, config.window, {tiling.columns, tiling.rows, tiling.halo, options.tiles.wrap});
  if (skips) return partsRunner(gpu, model, tiles, of, sparseOptions(config, options));
  return tiledRunner(gpu, model, tiles, of);
}

}  // namespace xrds
