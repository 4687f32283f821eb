#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "frames/session.h"

namespace xrds::test {

/// A frame of uniform noise in [0, 1), three floats a pixel, the same on every machine; `roll` low-resolution pixels of
/// its right edge stand at its left. The output is NaN until something is written there.
struct NoiseFrame {
  NoiseFrame(const NetworkConfig& config, FrameShape shape, uint32_t roll = 0) : frame(shape), scale(config.scale) {
    colour = image(shape, 1, roll, 1);
    for (size_t i = 0; i < config.auxInputs.size(); ++i)
      auxiliary.push_back(image(shape, scale, roll, static_cast<uint32_t>(i) + 2));
    output.assign(3 * size_t{frame.width} * frame.height * scale * scale, NAN);
  }
  static std::vector<float> image(FrameShape shape, uint32_t scale, uint32_t roll, uint32_t seed) {
    std::minstd_rand random(seed);
    const size_t width = size_t{shape.width} * scale, height = size_t{shape.height} * scale;
    std::vector<float> pixels(3 * width * height);
    for (size_t y = 0; y < height; ++y)
      for (size_t x = 0; x < width; ++x)
        for (size_t c = 0; c < 3; ++c)
          pixels[3 * (y * width + (x + size_t{roll} * scale) % width) + c] = static_cast<float>(random() % 4096) / 4096;
    return pixels;
  }
  /// `pixels` of this frame, `s` times as many in each direction as the low-resolution ones.
  PixelView view(const std::vector<float>& pixels, uint32_t s) const {
    return {pixels.data(), frame.width * s, frame.height * s};
  }
  FrameInput input(std::optional<float> exposure = {}) const {
    FrameInput all{view(colour, 1), {}, exposure};
    for (const auto& pixels : auxiliary) all.auxiliary.push_back(view(pixels, scale));
    return all;
  }

  FrameShape frame;
  uint32_t scale;
  std::vector<float> colour, output;
  std::vector<std::vector<float>> auxiliary;
};

}  // namespace xrds::test
