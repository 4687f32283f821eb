#include "checks/stress/frames.h"

#include <algorithm>
#include <iterator>

#include "checks/stress/inputs.h"
#include "frames/frame_exposure.h"
#include "image/repair.h"
#include "network/oidn.h"

namespace xrds {
namespace {

constexpr float kExposures[] = {1e-30f, 1e-6f, 1, 1e6f, 1e30f};

bool isBlackImage(const Image& image) {
  return std::all_of(image.pixels.begin(), image.pixels.end(), [](float value) { return value == 0; });
}

}  // namespace

bool StressFrame::isBlack() const {
  return isBlackImage(colour) && std::all_of(radianceInputs.begin(), radianceInputs.end(),
                                             [&](size_t input) { return isBlackImage(auxiliary[input]); });
}

void StressFrame::scaleLight(float factor) {
  for (float& value : colour.pixels) value *= factor;
  for (const size_t input : radianceInputs)
    for (float& value : auxiliary[input].pixels) value *= factor;
}

FrameInput StressFrame::input(bool autoExposure) const {
  const auto viewOf = [](const Image& image) {
    return PixelView{image.pixels.data(), static_cast<uint32_t>(image.width), static_cast<uint32_t>(image.height)};
  };
  FrameInput in{viewOf(colour)};
  for (const Image& image : auxiliary) in.auxiliary.push_back(viewOf(image));
  if (!autoExposure)
    in.exposure = givenExposure;
  else if (takesBinnedExposure)
    in.exposure = binnedExposure(in.colour);
  return in;
}

std::vector<StressFrame> stressFrames(const NetworkConfig& config, FrameShape shape, uint32_t seed, size_t turn) {
  const auto colours = stressColours(), auxiliaries = stressAuxiliaries();
  const auto naturalCount = static_cast<size_t>(
      std::count_if(auxiliaries.begin(), auxiliaries.end(), [](const StressInput& input) { return input.natural; }));
  std::vector<StressFrame> frames;
  for (size_t i = 0; i < colours.size(); ++i) {
    const bool natural = colours[i].natural;
    const size_t aux = natural ? i % naturalCount : (i + 5 * turn) % auxiliaries.size();
    const auto frameSeed = static_cast<uint32_t>(seed + 100 * turn + i);
    StressFrame frame{std::string(colours[i].name), natural, stressColour(i, shape, frameSeed),
                      stressAuxiliary(aux, i, config, shape, frameSeed)};
    frame.radianceInputs = config.radianceInputs();
    frame.takesBinnedExposure = takesBinnedExposure(config);
    if (!frame.auxiliary.empty()) frame.name += ", " + std::string(auxiliaries[aux].name);
    frame.repairedPixels = repairNonFinite(frame.colour).nonFinitePixels;
    for (Image& image : frame.auxiliary) frame.repairedPixels += repairNonFinite(image).nonFinitePixels;
    frame.givenExposure = kExposures[(i + turn) % std::size(kExposures)];
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace xrds
