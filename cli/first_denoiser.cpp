#include "cli/first_denoiser.h"

#include "app/byte_count.h"
#include "app/denoiser.h"
#include "app/failing_with.h"
#include "app/skip_bound.h"
#include "cli/progress.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

using Frames = FirstDenoiser::Frames;

NetworkDenoiser::Options networkOptions(const UpscaleOptions& options, Frames frames,
                                        const Upscaler::Progress& progress) {
  return {.folder = pathOf(options.denoisers),
          .fp16 = options.precision == kFp16,
          .memoryBytes = parseBytes(options.memory),
          .progress = progress,
          .staysPrepared = frames == Frames::many && options.memory.empty()};
}

// Guides of the frame that a network takes: none, the albedo, albedo and normal.
size_t guidesOf(const Frame& frame) { return !frame.imageOf(kAlbedo.name) ? 0 : !frame.imageOf(kNormal.name) ? 1 : 2; }

}  // namespace

bool denoisesOnDevice(const UpscaleOptions& options, const Frame& frame) {
  return FirstDenoiser(options, Frames::one, {}).takes(frame);
}

void denoiseByLibrary(const UpscaleOptions& options, Frame& frame) {
  failingWith(ExitCode::device, [&] {
    Denoiser library;
    frame.denoise(library, options.cleanGuides, options.ensemble);
  });
}

FirstDenoiser::FirstDenoiser(const UpscaleOptions& options, Frames frames, const Upscaler::Progress& progress)
    : options_(options), networks_(networkOptions(options, frames, progress)) {}

bool FirstDenoiser::takes(const Frame& frame) {
  if (!options_.denoiseFirst || options_.denoiseBy == "library") return false;
  const bool clean = options_.cleanGuides, isWanted = options_.denoiseBy == "networks" || !options_.denoisers.empty();
  if (!isWanted) return networks_.has(guidesOf(frame), clean, !clean);
  failingWith(ExitCode::model, [&] { networks_.load(guidesOf(frame), clean, !clean); });
  return true;
}

bool FirstDenoiser::goesAlong(const Frame& frame) {
  const bool isPlain = options_.ensemble == 1 && options_.memory.empty() && parseSkip(options_.skip) == 0 &&
                       !options_.keepUnchanged && !options_.wrap;
  const bool isLookedAt = options_.check || !options_.reference.empty() || !options_.sideBySide.empty();
  return isPlain && !isLookedAt && !frame.layers() && takes(frame);
}

void FirstDenoiser::prepare(std::optional<Upscaler>& upscaler, Device& device, const Model& model, const Frame& frame) {
  Upscaler::Options asked = options_.upscaler();
  asked.denoisers = networks_.inFront(frame.imageOf(kAlbedo.name), frame.imageOf(kNormal.name), options_.cleanGuides);
  try {
    upscaler.emplace(device, model, frame.width(), frame.height(), asked);
  } catch (const Cancelled&) {
    stopIfInterrupted();
    throw;
  }
}

void FirstDenoiser::denoise(Device& device, Frame& frame) {
  if (goesAlong(frame)) return frame.levelFor(networks_.name());
  DeviceDenoiser denoiser(networks_, device);
  untilInterrupted([&] { frame.denoise(denoiser, options_.cleanGuides, options_.ensemble); });
}

}  // namespace xrds
