#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "image/image.h"
#include "network/config.h"
#include "network/frame_shape.h"

namespace xrds {

/// An image that a stress run makes: how its pixels look, and whether a renderer could have made it.
struct StressInput {
  std::string_view name;
  bool natural = false;
};

/// The colour images and the pairs of albedo and normal, natural ones first.
std::span<const StressInput> stressColours();
std::span<const StressInput> stressAuxiliaries();

/// The colour [h, w, 3] number `which` of the table. The same for the same seed.
Image stressColour(size_t which, FrameShape frame, uint32_t seed);

/// The auxiliary images [s h, s w, 3] number `which` of the table, in the order of the model; of radiance that of
/// stressColour() number `colour`.
std::vector<Image> stressAuxiliary(size_t which, size_t colour, const NetworkConfig& config, FrameShape frame,
                                   uint32_t seed);

}  // namespace xrds
