#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace xrds {

/// The share of a picture that is made of the images with their noise, where an ensemble of denoised images goes
/// through a model that takes the full-resolution colour: its errors are others (docs/quality.md).
inline constexpr float kNoisyShare = 0.2F;

/// Makes of a picture the mean of log(1 + e x) with one of noisy images, of which it gets that share: x the pictures,
/// e the exposure. Both have as many floats.
inline void addNoisyShare(std::span<float> picture, std::span<const float> noisy, float exposure) {
  const auto transformed = [&](float x) { return std::log1p(exposure * std::max(x, 0.F)); };
  for (size_t i = 0; i < picture.size(); ++i)
    picture[i] =
        std::expm1((1 - kNoisyShare) * transformed(picture[i]) + kNoisyShare * transformed(noisy[i])) / exposure;
}

}  // namespace xrds
