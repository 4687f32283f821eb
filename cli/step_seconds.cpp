#include "cli/step_seconds.h"

#include <algorithm>

#include "app/denoiser.h"
#include "app/frame.h"
#include "app/models.h"
#include "app/network_denoiser.h"
#include "app/timer.h"
#include "cli/progress.h"

namespace xrds {
namespace {

// Of the piece, full-resolution pixels; the larger one is tried where the smaller takes less than kQuick seconds.
constexpr int kSides[] = {256, 1024};
constexpr double kQuick = 0.05;

// The first run prepares.
template <class Action>
double secondsOfSecondRun(Action&& action) {
  action();
  return secondsOf(action);
}

// `pieceSeconds` times a piece of side x side pixels.
template <class PieceSeconds>
double secondsPerPixel(PieceSeconds&& pieceSeconds) {
  double perPixel = 0;
  for (const int side : kSides) {
    const double seconds = pieceSeconds(side);
    perPixel = seconds / (static_cast<double>(side) * side);
    stopIfInterrupted();
    if (seconds > kQuick) break;
  }
  return perPixel;
}

double modelSeconds(Device& device, const Model& model, int side) {
  const int low = side / static_cast<int>(model.scale());
  const Image colour(low, low, 3, 0.5F), full(side, side, 3, 0.5F);
  const std::vector<PixelView> auxiliary(model.auxiliaryInputs().size(), viewOf(full));
  Image result = full;
  Upscaler upscaler(device, model, static_cast<uint32_t>(low), static_cast<uint32_t>(low), {});
  return secondsOfSecondRun([&] { upscaler.run(viewOf(colour), auxiliary, result.pixels); });
}

double secondsPerPixelOf(ImageDenoiser& denoiser) {
  return secondsPerPixel([&](int side) {
    const Image image(side, side, 3, 0.5F);
    return secondsOfSecondRun([&] {
      const Image albedo = denoiser.denoisedAlbedo(image), normal = denoiser.denoisedNormal(image);
      denoiser.denoised(image, &albedo, &normal);
    });
  });
}

// The networks on the device where they were imported, as --denoise-first runs them, else the library.
void measureDenoiser(Device& device, size_t pixels, StepSeconds& steps) {
  NetworkDenoiser networks({.staysPrepared = true});
  steps.denoiserIsImported = networks.has(2, false, true);
  if (steps.denoiserIsImported) {
    DeviceDenoiser denoiser(networks, device);
    steps.denoiser = static_cast<double>(pixels) * secondsPerPixelOf(denoiser);
    networks.release();
    return;
  }
  try {
    Denoiser library;
    steps.denoiser = static_cast<double>(pixels) * secondsPerPixelOf(library);
  } catch (const Error&) {  // none is installed
  }
}

}  // namespace

StepSeconds measureSteps(Device& device, const std::vector<Way>& ways, size_t pixels) {
  StepSeconds steps;
  const std::vector<std::string> shipped = shippedModels();
  for (const Way& way : ways) {
    const bool isShipped = std::find(shipped.begin(), shipped.end(), way.model) != shipped.end();
    if (!isShipped || steps.models.contains(way.model)) continue;
    const Model model(resolveModel(way.model));
    steps.models[way.model] =
        static_cast<double>(pixels) * secondsPerPixel([&](int side) { return modelSeconds(device, model, side); });
  }
  measureDenoiser(device, pixels, steps);
  return steps;
}

}  // namespace xrds
