#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "xrds/xrds.h"
#include "xrds/xrds.hpp"

namespace xrds::test {

inline constexpr uint32_t kWidth = 14, kHeight = 9, kScale = 4, kWide = kScale * kWidth, kHigh = kScale * kHeight;
inline const std::string kModel = XRDS_GOLDEN_FOLDER "/s4_guided.model.safetensors";

/// Numbers in (0.05, 1.05), the same on every machine.
inline std::vector<float> noise(size_t count, uint32_t seed) {
  std::vector<float> values(count);
  for (float& value : values) value = 0.05F + static_cast<float>((seed = seed * 1664525 + 1013904223) >> 8) * 0x1p-24F;
  return values;
}

inline XrdsImage rgb(std::vector<float>& pixels, uint32_t width, uint32_t height) {
  return xrdsInterleavedImage(pixels.data(), XRDS_FLOAT, 3, width, height);
}

/// A device, a model and an upscaler, with a frame for them.
class CApi : public testing::Test {
 public:  // threads of a test use it
  void SetUp() override {
    ASSERT_EQ(xrdsOpenDevice(nullptr, &device), XRDS_OK) << xrdsGetMessage();
    ASSERT_EQ(xrdsOpenModel(kModel.c_str(), &model), XRDS_OK) << xrdsGetMessage();
    ASSERT_EQ(xrdsCreateUpscaler(device, model, kWidth, kHeight, nullptr, &upscaler), XRDS_OK) << xrdsGetMessage();
  }
  void TearDown() override {  // in the order that looks wrong
    xrdsCloseDevice(device);
    xrdsCloseModel(model);
    xrdsDestroyUpscaler(upscaler);
  }
  XrdsResult run(XrdsProgress progress = nullptr, void* user = nullptr) {
    return xrdsUpscale(upscaler, &colour, auxiliary, 2, &output, progress, user);
  }
  // What the C++ classes make of the frame.
  std::vector<float> expected() const {
    Device device;
    const Model model(kModel);
    Upscaler upscaler(device, model, kWidth, kHeight, {});
    std::vector<float> output(outputPixels.size());
    const PixelView auxiliary[] = {{albedo.data(), kWide, kHigh}, {normal.data(), kWide, kHigh}};
    upscaler.run({colourPixels.data(), kWidth, kHeight}, auxiliary, output);
    return output;
  }

  XrdsDevice* device = nullptr;
  XrdsModel* model = nullptr;
  XrdsUpscaler* upscaler = nullptr;
  std::vector<float> colourPixels = noise(3 * kWidth * kHeight, 1), albedo = noise(3 * kWide * kHigh, 2),
                     normal = noise(3 * kWide * kHigh, 3), outputPixels = std::vector<float>(3 * kWide * kHigh, -1);
  XrdsImage colour = rgb(colourPixels, kWidth, kHeight), output = rgb(outputPixels, kWide, kHigh);
  XrdsImage auxiliary[2] = {rgb(albedo, kWide, kHigh), rgb(normal, kWide, kHigh)};
};

}  // namespace xrds::test
