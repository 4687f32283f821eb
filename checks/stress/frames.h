#pragma once

#include <string>
#include <vector>

#include "frames/session.h"
#include "image/image.h"

namespace xrds {

/// A frame as Upscaler::run hands it to a session.
struct StressFrame {
  std::string name;
  bool natural = false;
  Image colour;
  std::vector<Image> auxiliary;
  uint64_t repairedPixels = 0;
  float givenExposure = 1;
  std::vector<size_t> radianceInputs;  // which of the auxiliary images are radiance
  bool takesBinnedExposure = false;    // where the exposure is automatic

  bool isBlack() const;
  /// Multiplies its light, of all images that are radiance.
  void scaleLight(float factor);
  FrameInput input(bool autoExposure) const;
};

/// Every colour, natural ones with natural auxiliary images, the others with all of them in turn. Deterministic.
std::vector<StressFrame> stressFrames(const NetworkConfig& config, FrameShape shape, uint32_t seed, size_t turn);

}  // namespace xrds
