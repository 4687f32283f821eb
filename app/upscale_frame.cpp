#include "app/upscale_frame.h"

#include "app/models.h"
#include "xrds/noisy_share.h"

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
  addNoisyShare(output, noisy, upscaler.exposure());
  return true;
}

}  // namespace xrds
