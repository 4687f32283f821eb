#include "cli/step_seconds.h"

#include <chrono>

#include "app/denoiser.h"
#include "app/frame.h"
#include "app/models.h"
#include "cli/progress.h"

namespace xrds {
namespace {

constexpr int kSides[] = {256,
                          1024};  // of the piece, full-resolution pixels; the larger one where the smaller is quick
constexpr double kQuick = 0.05;   // seconds

template <class Action>
double secondsOf(Action&& action) {
  const auto start = std::chrono::steady_clock::now();
  action();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Of an action that makes a piece of `side` x `side` pixels, the second time that it runs; for a pixel.
template <class MakePiece>
double secondsPerPixel(MakePiece&& makePiece) {
  double perPixel = 0;
  for (const int side : kSides) {
    const double seconds = makePiece(side);
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
  const auto run = [&] { upscaler.run(viewOf(colour), auxiliary, result.pixels); };
  run();
  return secondsOf(run);
}

std::optional<double> denoiserSeconds(size_t pixels) {
  try {
    const Denoiser denoiser;
    return static_cast<double>(pixels) * secondsPerPixel([&](int side) {
             const Image image(side, side, 3, 0.5F);
             const auto run = [&] { denoiser.denoised(image, &image, &image); };
             run();
             return secondsOf(run);
           });
  } catch (const Error&) {
    return {};  // none is installed
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
  steps.denoiser = denoiserSeconds(pixels);
  return steps;
}

}  // namespace xrds
