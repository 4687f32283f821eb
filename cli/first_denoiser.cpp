#include "cli/first_denoiser.h"

#include "app/byte_count.h"
#include "app/denoiser.h"
#include "app/failing_with.h"
#include "cli/progress.h"

namespace xrds {
namespace {

NetworkDenoiser::Options networkOptions(const UpscaleOptions& options, const Upscaler::Progress& progress = {}) {
  return {.folder = options.denoisers,
          .fp16 = options.precision == kFp16,
          .memoryBytes = parseBytes(options.memory),
          .progress = progress};
}

// Guides of the frame that a network takes: none, the albedo, albedo and normal.
size_t guidesOf(const Frame& frame) { return !frame.imageOf(kAlbedo.name) ? 0 : !frame.imageOf(kNormal.name) ? 1 : 2; }

}  // namespace

bool denoisesOnDevice(const UpscaleOptions& options, const Frame& frame) {
  if (!options.denoiseFirst || options.denoiseBy == "library") return false;
  NetworkDenoiser networks(networkOptions(options));
  const bool isWanted = options.denoiseBy == "networks" || !options.denoisers.empty();
  if (!isWanted) return networks.has(guidesOf(frame), options.cleanGuides, !options.cleanGuides);
  failingWith(ExitCode::model, [&] { networks.load(guidesOf(frame), options.cleanGuides, !options.cleanGuides); });
  return true;
}

void denoiseByLibrary(const UpscaleOptions& options, Frame& frame) {
  failingWith(ExitCode::device, [&] {
    Denoiser library;
    frame.denoise(library, options.cleanGuides, options.ensemble);
  });
}

FirstDenoiser::FirstDenoiser(const UpscaleOptions& options, const Upscaler::Progress& progress)
    : options_(options), networks_(networkOptions(options, progress)) {}

void FirstDenoiser::denoise(Device& device, Frame& frame) {
  DeviceDenoiser denoiser(networks_, device);
  try {
    frame.denoise(denoiser, options_.cleanGuides, options_.ensemble);
  } catch (const Cancelled&) {
    stopIfInterrupted();
    throw;
  }
}

}  // namespace xrds
