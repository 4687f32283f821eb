#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <optional>

#include "engine/half.h"
#include "tests/c_api.h"
#include "tests/heap_count.h"
#include "tests/vulkan_host.h"

namespace xrds::test {

/// How pixels lie in a buffer.
struct Layout {
  XrdsFormat format = XRDS_FLOAT;
  uint32_t channels = 3;
  uint64_t offset = 0, padding = 0;  // bytes, the latter behind each row
};

/// A host with a device, a model and an upscaler, and frames for them. Fails of what the validation layer says.
class Embedded : public testing::Test {
 public:
  void SetUp() override { open(14, 9, xrdsUpscalerOptionsDefault()); }

  void open(uint32_t wide, uint32_t high, XrdsUpscalerOptions options) {
    width = wide, height = high;
    if (!host) {
      host.emplace();
      const XrdsVulkanDevice vulkan = host->vulkan();
      ASSERT_EQ(xrdsOpenVulkanDevice(&vulkan, nullptr, &device), XRDS_OK) << xrdsGetMessage();
      ASSERT_EQ(xrdsOpenModel(kModel.c_str(), &model), XRDS_OK) << xrdsGetMessage();
    }
    xrdsDestroyUpscaler(upscaler);
    ASSERT_EQ(xrdsCreateUpscaler(device, model, width, height, &options, &upscaler), XRDS_OK) << xrdsGetMessage();
    pixels[0] = noise(size_t{3} * width * height, 1);
    for (uint32_t i = 1; i < 3; ++i) pixels[i] = noise(size_t{3} * kScale * kScale * width * height, 1 + i);
  }

  void TearDown() override {
    if (!host) return;
    host->await();
    for (XrdsRecording* recording : recordings) xrdsDestroyRecording(recording);
    xrdsDestroyUpscaler(upscaler);
    xrdsCloseModel(model);
    xrdsCloseDevice(device);
    host.reset();  // the layer names what was not destroyed
    for (const std::string& message : VulkanHost::messages()) ADD_FAILURE() << "validation: " << message;
    VulkanHost::messages().clear();
  }

  // What xrdsUpscale() makes of the pixels.
  std::vector<float> expected() {
    std::vector<float> output(pixels[1].size());
    const uint32_t w = kScale * width, h = kScale * height;
    upscale(rgb(pixels[0], width, height), rgb(output, w, h));
    return output;
  }
  void upscale(const XrdsImage& colour, const XrdsImage& output) {
    const uint32_t w = kScale * width, h = kScale * height;
    const XrdsImage auxiliary[] = {rgb(pixels[1], w, h), rgb(pixels[2], w, h)};
    EXPECT_EQ(xrdsUpscale(upscaler, &colour, auxiliary, 2, &output, nullptr, nullptr), XRDS_OK) << xrdsGetMessage();
  }

  struct Picture {
    HostBuffer memory;
    XrdsVulkanImage image;
    Layout layout;
  };

  Picture picture(uint32_t w, uint32_t h, const Layout& layout) {
    const uint64_t row = uint64_t{w} * layout.channels * numberBytes(layout) + layout.padding;
    Picture made{host->buffer(layout.offset + row * h), {}, layout};
    made.image = xrdsBufferImage(made.memory.buffer, layout.format, layout.channels, w, h);
    made.image.offset = layout.offset;
    made.image.rowPitch = layout.padding ? row : 0;
    return made;
  }

  static uint64_t numberBytes(const Layout& layout) { return layout.format == XRDS_HALF ? 2 : 4; }
  static std::byte* at(const Picture& picture, uint32_t x, uint32_t y, uint32_t c) {
    const uint64_t pixel = picture.layout.channels * numberBytes(picture.layout),
                   row = picture.image.width * pixel + picture.layout.padding;
    return picture.memory.bytes + picture.layout.offset + y * row + x * pixel + c * numberBytes(picture.layout);
  }
  static void set(const Picture& to, const std::vector<float>& values) {
    for (uint32_t y = 0, i = 0; y < to.image.height; ++y)
      for (uint32_t x = 0; x < to.image.width; ++x)
        for (uint32_t c = 0; c < 3; ++c, ++i) setNumber(to, x, y, c, values[i]);
  }
  static void setNumber(const Picture& to, uint32_t x, uint32_t y, uint32_t c, float value) {
    const uint16_t half = toHalf(value);
    if (to.layout.format == XRDS_HALF)
      std::memcpy(at(to, x, y, c), &half, 2);
    else
      std::memcpy(at(to, x, y, c), &value, 4);
  }
  static float number(const Picture& from, uint32_t x, uint32_t y, uint32_t c) {
    uint16_t half = 0;
    float value = 0;
    std::memcpy(&half, at(from, x, y, c), 2);
    if (from.layout.format == XRDS_HALF) return fromHalf(half);
    std::memcpy(&value, at(from, x, y, c), 4);
    return value;
  }
  static std::vector<float> get(const Picture& from) {
    std::vector<float> values;
    for (uint32_t y = 0; y < from.image.height; ++y)
      for (uint32_t x = 0; x < from.image.width; ++x)
        for (uint32_t c = 0; c < 3; ++c) values.push_back(number(from, x, y, c));
    return values;
  }

  struct Frame {
    Picture colour, auxiliary[2], output;
    XrdsVulkanImage images[2];
    XrdsVulkanFrame frame;
    XrdsRecording* recording = nullptr;
  };

  // With the fixture's pixels in it; recorded by record().
  Frame frame(const Layout& input = {}, const Layout& output = {}) {
    const uint32_t w = kScale * width, h = kScale * height;
    Frame made{picture(width, height, input),
               {picture(w, h, input), picture(w, h, input)},
               picture(w, h, output),
               {},
               xrdsVulkanFrameDefault()};
    set(made.colour, pixels[0]);
    for (int i = 0; i < 2; ++i) set(made.auxiliary[i], pixels[1 + i]), made.images[i] = made.auxiliary[i].image;
    made.frame.colour = made.colour.image;
    made.frame.output = made.output.image;
    made.frame.auxiliaryCount = 2;
    return made;
  }
  void prepare(Frame& frame) {
    frame.frame.auxiliary = frame.images;
    ASSERT_EQ(xrdsCreateRecording(upscaler, &frame.frame, &frame.recording), XRDS_OK) << xrdsGetMessage();
    recordings.push_back(frame.recording);
  }
  VkCommandBuffer recorded(const Frame& frame) {
    const VkCommandBuffer commands = host->begin();
    EXPECT_EQ(xrdsRecord(frame.recording, commands), XRDS_OK) << xrdsGetMessage();
    host->end(commands);
    return commands;
  }
  // The same, which calls Vulkan once and allocates nothing.
  VkCommandBuffer recordedWithoutAllocating(const Frame& frame) {
    const VkCommandBuffer commands = host->begin();
    VulkanHost::takeCalls();
    {
      const HeapCount heap;
      const XrdsResult result = xrdsRecord(frame.recording, commands);
      EXPECT_EQ(heap.allocations(), 0u);
      EXPECT_EQ(result, XRDS_OK) << xrdsGetMessage();
    }
    {
      const HeapCount heap;
      ::operator delete(::operator new(4));
      EXPECT_EQ(heap.allocations(), 1u);  // it does count
    }
    const std::vector<std::pair<std::string, int>> calls = VulkanHost::takeCalls();
    EXPECT_EQ(calls, (std::vector<std::pair<std::string, int>>{{"vkCmdExecuteCommands", 1}}));
    host->end(commands);
    return commands;
  }
  void run(Frame& frame) {
    prepare(frame);
    if (!frame.recording) return;
    host->submit(recorded(frame));
    host->await();
  }

  uint32_t width = 0, height = 0;
  std::optional<VulkanHost> host;
  XrdsDevice* device = nullptr;
  XrdsModel* model = nullptr;
  XrdsUpscaler* upscaler = nullptr;
  std::vector<XrdsRecording*> recordings;
  std::vector<float> pixels[3];
};

}  // namespace xrds::test
