#pragma once

#include <span>

#include "app/frame.h"

namespace xrds {

/// The share of a result that is made of the images with their noise, in an ensemble of denoised ones: its errors are
/// others (docs/quality.md).
inline constexpr float kNoisyShare = 0.2F;

/// Runs the upscaler of a frame. Of one that denoise() has taken several passes to, a model that takes the
/// full-resolution colour makes the mean of log(1 + e x) of both, with the share above: x the result, e the exposure.
/// output: 3 floats a pixel. Returns false if `progress` cancelled it. Throws Error.
bool upscaleFrame(Upscaler& upscaler, const Model& model, const Frame& frame, std::span<float> output,
                  const Upscaler::Progress& progress);

}  // namespace xrds
