#pragma once

#include <span>

#include "app/frame.h"

namespace xrds {

/// Runs the upscaler of a frame. Of one that denoise() has taken several passes to, a model that takes the
/// full-resolution colour makes a share of the result of the images with their noise (addNoisyShare()). output: 3
/// floats a pixel. Returns false if `progress` cancelled it. Throws Error.
bool upscaleFrame(Upscaler& upscaler, const Model& model, const Frame& frame, std::span<float> output,
                  const Upscaler::Progress& progress);

}  // namespace xrds
