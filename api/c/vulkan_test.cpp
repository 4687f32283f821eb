// xrds in a program with a Vulkan device of its own: the same pictures as xrdsUpscale() gives, in its buffers.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>
#include <thread>

#include "engine/half.h"
#include "tests/noise_frame.h"
#include "tests/vulkan_host.h"
#include "xrds/xrds.hpp"

namespace xrds {
namespace {

const std::string kModel = XRDS_GOLDEN_FOLDER "/s4_guided.model.safetensors";
constexpr uint32_t kScale = 4;

std::vector<float> noise(size_t count, uint32_t seed) {
  std::vector<float> values(count);
  for (float& value : values) value = 0.05F + static_cast<float>((seed = seed * 1664525 + 1013904223) >> 8) * 0x1p-24F;
  return values;
}

/// How pixels lie in a buffer.
struct Layout {
  XrdsFormat format = XRDS_FLOAT;
  uint32_t channels = 3;
  uint64_t offset = 0, padding = 0;  // bytes, the latter behind each row
};

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
    for (const std::string& message : host->messages) ADD_FAILURE() << "validation: " << message;
  }

  // What xrdsUpscale() makes of the pixels.
  std::vector<float> expected() {
    std::vector<float> output(pixels[1].size());
    const uint32_t w = kScale * width, h = kScale * height;
    const XrdsImage colour = xrdsInterleavedImage(pixels[0].data(), XRDS_FLOAT, 3, width, height);
    const XrdsImage auxiliary[] = {xrdsInterleavedImage(pixels[1].data(), XRDS_FLOAT, 3, w, h),
                                   xrdsInterleavedImage(pixels[2].data(), XRDS_FLOAT, 3, w, h)};
    const XrdsImage picture = xrdsInterleavedImage(output.data(), XRDS_FLOAT, 3, w, h);
    EXPECT_EQ(xrdsUpscale(upscaler, &colour, auxiliary, 2, &picture, nullptr, nullptr), XRDS_OK) << xrdsGetMessage();
    return output;
  }

  struct Picture {
    test::HostBuffer memory;
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
        for (uint32_t c = 0; c < 3; ++c, ++i) {
          const uint16_t half = toHalf(values[i]);
          if (to.layout.format == XRDS_HALF)
            std::memcpy(at(to, x, y, c), &half, 2);
          else
            std::memcpy(at(to, x, y, c), &values[i], 4);
        }
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
  void run(Frame& frame) {
    prepare(frame);
    if (!frame.recording) return;
    host->submit(recorded(frame));
    host->await();
  }

  uint32_t width = 0, height = 0;
  std::optional<test::VulkanHost> host;
  XrdsDevice* device = nullptr;
  XrdsModel* model = nullptr;
  XrdsUpscaler* upscaler = nullptr;
  std::vector<XrdsRecording*> recordings;
  std::vector<float> pixels[3];
};

TEST_F(Embedded, GivesThePictureOfUpscale) {
  Frame mine = frame();
  run(mine);
  EXPECT_EQ(get(mine.output), expected());
}

// The command buffer is of the host's own, which is what makes a frame: nothing of the library runs between.
TEST_F(Embedded, RecordsOnceAndReplaysWithoutAllocatingOrSubmittingOrCopying) {
  Frame mine = frame();
  prepare(mine);
  const VkCommandBuffer commands = host->begin();
  test::VulkanHost::takeCalls();
  ASSERT_EQ(xrdsRecord(mine.recording, commands), XRDS_OK);
  const std::vector<std::pair<std::string, int>> calls = test::VulkanHost::takeCalls();
  EXPECT_EQ(calls, (std::vector<std::pair<std::string, int>>{{"vkCmdExecuteCommands", 1}}));
  host->end(commands);
  for (uint32_t seed = 10; seed < 13; ++seed) {
    pixels[0] = noise(pixels[0].size(), seed);
    set(mine.colour, pixels[0]);
    host->submit(commands);
    host->await();
    EXPECT_TRUE(test::VulkanHost::takeCalls().empty());
    EXPECT_EQ(get(mine.output), expected()) << seed;
    test::VulkanHost::takeCalls();
  }
}

TEST_F(Embedded, KeepsSeveralFramesInFlight) {
  std::vector<Frame> frames;
  std::vector<std::vector<float>> wanted;
  std::vector<VkCommandBuffer> commands;
  for (uint32_t i = 0; i < 3; ++i) {
    pixels[0] = noise(pixels[0].size(), 20 + i);
    frames.push_back(frame());
    wanted.push_back(expected());
  }
  for (Frame& each : frames) prepare(each), commands.push_back(recorded(each));
  for (int again = 0; again < 2; ++again)  // also the same command buffer twice
    for (const VkCommandBuffer each : commands) host->submit(each);
  host->await();
  for (size_t i = 0; i < frames.size(); ++i) EXPECT_EQ(get(frames[i].output), wanted[i]) << i;
}

TEST_F(Embedded, TakesAnyLayoutOfPixels) {
  for (std::vector<float>& image : pixels)
    for (float& value : image) value = fromHalf(toHalf(value));
  const std::vector<float> wanted = expected();
  const Layout layouts[] = {{XRDS_FLOAT, 4, 0, 0}, {XRDS_FLOAT, 3, 4, 0}, {XRDS_FLOAT, 4, 1028, 52},
                            {XRDS_HALF, 4, 0, 0},  {XRDS_HALF, 3, 0, 0},  {XRDS_HALF, 3, 772, 8},
                            {XRDS_HALF, 4, 4, 64}};
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(testing::Message() << layout.format << ' ' << layout.channels << ' ' << layout.offset);
    Frame mine = frame(layout, layout);
    std::memset(mine.output.memory.bytes, 0x5A, layout.offset + 4);
    run(mine);
    std::vector<float> stored = wanted;
    if (layout.format == XRDS_HALF)
      for (float& value : stored) value = fromHalf(toHalf(value));
    EXPECT_EQ(get(mine.output), stored);
    for (uint64_t i = 0; i < layout.offset; ++i) ASSERT_EQ(mine.output.memory.bytes[i], std::byte{0x5A}) << i;
    if (layout.channels == 4) EXPECT_EQ(number(mine.output, 3, 5, 3), 1);
  }
}

TEST_F(Embedded, IsFiniteWhateverThePixels) {
  pixels[0][5] = NAN;
  pixels[1][7] = INFINITY;
  for (size_t i = 3000; i < 3400; ++i) pixels[2][i] = -INFINITY;
  Frame mine = frame();
  run(mine);
  for (const float value : get(mine.output)) ASSERT_TRUE(std::isfinite(value));
  pixels[2] = noise(pixels[2].size(), 3);  // single pixels become what xrdsUpscale() makes of them
  Frame holes = frame();
  run(holes);
  const std::vector<float> found = get(holes.output), wanted = expected();
  for (size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], wanted[i], 1e-6F * (1 + wanted[i])) << i;
}

TEST_F(Embedded, TakesAnExposureOfTheUpscalerOrOfEachFrame) {
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.exposure = 0.7F;
  open(14, 9, options);
  const std::vector<float> wanted = expected();
  Frame fixed = frame();
  run(fixed);
  EXPECT_EQ(get(fixed.output), wanted);
  options.exposure = 1;
  open(14, 9, options);
  const test::HostBuffer exposure = host->buffer(64);
  Frame given = frame();
  given.frame.exposure = exposure.buffer;
  given.frame.exposureOffset = 12;
  const float value = 0.7F;
  std::memcpy(exposure.bytes + 12, &value, sizeof value);
  run(given);
  const std::vector<float> found = get(given.output);
  for (size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], wanted[i], 1e-6F) << i;
}

TEST_F(Embedded, StoresHalves) {
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.fp16 = 1;
  open(13, 17, options);
  Frame mine = frame();
  run(mine);
  EXPECT_EQ(get(mine.output), expected());
}

// As wide as one arena is too small for: tiles, whose exposure is of the whole frame.
TEST_F(Embedded, RecordsTiles) {
  open(72, 40, xrdsUpscalerOptionsDefault());
  const uint64_t whole = xrdsGetDeviceBytes(upscaler);
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.memoryBytes = whole / 2;
  open(72, 40, options);
  ASSERT_LT(xrdsGetDeviceBytes(upscaler), whole);
  Frame mine = frame();
  run(mine);
  EXPECT_EQ(get(mine.output), expected());
}

TEST_F(Embedded, SubmitsBehindSemaphoresAndSignalsThem) {
  Frame mine = frame();
  prepare(mine);
  const VkSemaphore before = host->timeline(), after = host->timeline();
  const std::vector<float> wanted = expected();
  std::memset(mine.output.memory.bytes, 0, 64);
  for (uint64_t frame = 1; frame <= 3; ++frame) {
    const XrdsTimelinePoint wait{before, frame}, signal{after, 10 * frame};
    ASSERT_EQ(xrdsSubmit(mine.recording, &wait, 1, &signal, 1), XRDS_OK) << xrdsGetMessage();
  }
  uint64_t value = 1;
  host->vk.vkGetSemaphoreCounterValue(host->device, after, &value);
  EXPECT_EQ(value, 0u);
  EXPECT_EQ(number(mine.output, 0, 0, 0), 0);
  VkSemaphoreSignalInfo go{VK_STRUCTURE_TYPE_SEMAPHORE_SIGNAL_INFO};
  go.semaphore = before;
  go.value = 3;
  host->vk.vkSignalSemaphore(host->device, &go);
  VkSemaphoreWaitInfo wait{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};
  const uint64_t last = 30;
  wait.semaphoreCount = 1;
  wait.pSemaphores = &after;
  wait.pValues = &last;
  ASSERT_EQ(host->vk.vkWaitSemaphores(host->device, &wait, 60'000'000'000), VK_SUCCESS);
  EXPECT_EQ(get(mine.output), wanted);
}

}  // namespace
}  // namespace xrds
