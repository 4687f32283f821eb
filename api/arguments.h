#pragma once

#include <span>

#include "network/config.h"
#include "network/network.h"
#include "xrds/upscaler.h"

namespace xrds {

/// What callers hand to the public API, refused before anything is made of it. Each throws Error that names the option
/// or the image, what it is and what it may be.
void checkOptions(const Upscaler::Options& options);
void checkOptions(const TileOptions& options);
/// The size of a low-resolution frame, in tiles or not.
void checkShape(const NetworkConfig& config, FrameShape frame);
void checkImages(const NetworkConfig& config, FrameShape frame, const PixelView& colour,
                 std::span<const PixelView> auxiliary);
void checkOutput(const NetworkConfig& config, FrameShape frame, std::span<const float> output);

/// "640 x 480".
std::string sizeText(uint32_t width, uint32_t height);

}  // namespace xrds
