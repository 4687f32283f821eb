#include "app/upscale_frame.h"

#include <algorithm>
#include <cmath>

#include "app/models.h"

namespace xrds {
namespace {

// Of a run that is one half of all.
Upscaler::Progress halfOf(const Upscaler::Progress& progress, double begin) {
  if (!progress) return {};
  return [&progress, begin](double share) { return progress(begin + share / 2); };
}

}  // namespace

bool upscaleFrame(Upscaler& upscaler, const Model& model, const Frame& frame, std::span<float> output,
                  const Upscaler::Progress& progress) {
  const auto inputs = inputsOf(model, frame);
  if (!frame.noisy() || !takes(model, kFullColour))
    return upscaler.run(viewOf(frame.colour()), inputs, output, progress);
  const auto& [colour, auxiliary] = *frame.noisy();
  std::vector<float> noisy(output.size());
  if (!upscaler.run(viewOf(colour), inputsOf(model, frame.inputs(), auxiliary), noisy, halfOf(progress, 0)) ||
      !upscaler.run(viewOf(frame.colour()), inputs, output, halfOf(progress, 0.5)))
    return false;
  const float exposure = upscaler.exposure();
  const auto transformed = [&](float x) { return std::log1p(exposure * std::max(x, 0.F)); };
  for (size_t i = 0; i < output.size(); ++i)
    output[i] = std::expm1((1 - kNoisyShare) * transformed(output[i]) + kNoisyShare * transformed(noisy[i])) / exposure;
  return true;
}

}  // namespace xrds
