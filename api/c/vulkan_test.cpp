// xrds in a program with a Vulkan device of its own: the same pictures as xrdsUpscale() gives, in its buffers.
#include <algorithm>
#include <cmath>
#include <new>

#include "tests/embedded.h"

namespace xrds {
namespace {

using test::Embedded;
using test::Layout;
using test::noise;

TEST_F(Embedded, GivesThePictureOfUpscale) {
  Frame mine = frame();
  run(mine);
  EXPECT_EQ(get(mine.output), expected());
}

// The command buffer is of the host's own, which is what makes a frame: nothing of the library runs between.
TEST_F(Embedded, RecordsOnceAndReplaysWithoutAllocatingOrSubmittingOrCopying) {
  Frame mine = frame();
  prepare(mine);
  const VkCommandBuffer commands = recordedWithoutAllocating(mine);
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

// Piece by piece, so that others get the queue in between.
TEST_F(Embedded, RunsAndWaits) {
  Frame mine = frame();
  prepare(mine);
  std::vector<double> shares;
  const auto hear = [](void* user, double share) {
    static_cast<std::vector<double>*>(user)->push_back(share);
    return 1;
  };
  ASSERT_EQ(xrdsRun(mine.recording, hear, &shares), XRDS_OK) << xrdsGetMessage();
  const std::vector<float> found = get(mine.output);
  const float exposure = xrdsGetRecordingExposure(mine.recording);
  EXPECT_EQ(found, expected());
  EXPECT_EQ(exposure, xrdsGetExposure(upscaler));
  ASSERT_FALSE(shares.empty());
  EXPECT_EQ(shares.back(), 1);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(xrdsRun(mine.recording, nullptr, nullptr), XRDS_OK);
  const auto stop = [](void*, double) { return 0; };
  EXPECT_EQ(xrdsRun(mine.recording, stop, nullptr), XRDS_CANCELLED);
  EXPECT_EQ(xrdsRun(nullptr, nullptr, nullptr), XRDS_ERROR_ARGUMENT);
  EXPECT_EQ(xrdsGetRecordingExposure(nullptr), 0);
}

TEST_F(Embedded, KnowsDevicesAsTheSelectionDoes) {
  VkPhysicalDevice found = VK_NULL_HANDLE;
  ASSERT_EQ(xrdsSelectVulkanDevice(nullptr, host->instance, "0", &found), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(found, host->physicalDevice);
  found = VK_NULL_HANDLE;
  EXPECT_EQ(xrdsSelectVulkanDevice(nullptr, host->instance, "no such device", &found), XRDS_ERROR_FAILED);
  EXPECT_NE(std::string(xrdsGetMessage()).find("no such device"), std::string::npos) << xrdsGetMessage();
  EXPECT_EQ(found, VkPhysicalDevice{});
  EXPECT_EQ(xrdsSelectVulkanDevice(nullptr, host->instance, "0", nullptr), XRDS_ERROR_ARGUMENT);
  EXPECT_EQ(xrdsSelectVulkanDevice(nullptr, nullptr, "0", &found), XRDS_ERROR_ARGUMENT);
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
    if (layout.channels == 4) {
      EXPECT_EQ(number(mine.output, 3, 5, 3), 1);
    }
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

// Of the host's images in any layout; their pixels go there and back through its own copies.
TEST_F(Embedded, TakesImages) {
  const std::vector<float> wanted = expected();
  const VkImageUsageFlags usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                  VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT;
  struct Case {
    XrdsFormat format;
    VkImageLayout input, output;
    float alpha;  // everywhere; below 1 it is asked for
  };
  for (const Case& each :
       {Case{XRDS_FLOAT, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL, 1},
        Case{XRDS_FLOAT, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL, 0.25F},
        Case{XRDS_HALF, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, 0.5F}}) {
    const bool halves = each.format == XRDS_HALF;
    const VkFormat format = halves ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_R32G32B32A32_SFLOAT;
    Frame mine = frame({each.format, 4}, {each.format, 4});
    XrdsVulkanImage* images[] = {&mine.frame.colour, &mine.images[0], &mine.images[1], &mine.frame.output};
    const Picture* buffers[] = {&mine.colour, &mine.auxiliary[0], &mine.auxiliary[1], &mine.output};
    for (uint32_t i = 0; i < width * height; ++i) setNumber(mine.colour, i % width, i / width, 3, each.alpha);
    if (each.alpha < 1) mine.frame.alpha = &mine.frame.colour;
    const VkCommandBuffer fill = host->begin(), read = host->begin();
    for (size_t i = 0; i < 4; ++i) {
      const uint32_t w = buffers[i]->image.width, h = buffers[i]->image.height;
      *images[i] = xrdsWholeImage(host->image(w, h, format, usage).image, each.format, w, h);
      images[i]->layout = i == 3 ? each.output : each.input;
      host->transition(fill, images[i]->image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
      host->copy(fill, buffers[i]->memory.buffer, images[i]->image, w, h, true);
      host->transition(fill, images[i]->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, images[i]->layout);
    }
    host->end(fill);
    host->submit(fill);
    run(mine);
    const XrdsVulkanImage& output = mine.frame.output;
    host->transition(read, output.image, output.layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    host->copy(read, mine.output.memory.buffer, output.image, output.width, output.height, false);
    host->end(read);
    host->submit(read);
    host->await();
    const std::vector<float> found = get(mine.output);
    for (size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], wanted[i], halves ? 3e-3F : 0.F) << i;
    EXPECT_NEAR(number(mine.output, 2, 3, 3), each.alpha, 1e-6);
  }
}

// The frame waits for another device of the GPU and tells it the end; nobody waits on the host between the two.
TEST_F(Embedded, SharesTimelinesWithAnotherDevice) {
  test::VulkanHost other;
  if (!host->sharesTimelines()) GTEST_SKIP() << "the device shares no timeline semaphores by file descriptor";
  int descriptors[2] = {-1, -1};
  const VkSemaphore theirs[] = {other.exportedTimeline(descriptors[0]), other.exportedTimeline(descriptors[1])};
  const XrdsTimelinePoint before{host->importedTimeline(descriptors[0]), 3},
      after{host->importedTimeline(descriptors[1]), 7};
  Frame mine = frame();
  prepare(mine);
  const std::vector<float> wanted = expected();
  std::memset(mine.output.memory.bytes, 0, 64);
  ASSERT_EQ(xrdsSubmit(mine.recording, &before, 1, &after, 1), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(number(mine.output, 0, 0, 0), 0);
  other.signal({theirs[0], 3});
  other.await({theirs[1], 7});
  EXPECT_EQ(get(mine.output), wanted);
}

// Binary semaphores as sync files, which the host's queue turns into timelines and back.
TEST_F(Embedded, SharesSignalsWithAnotherDevice) {
  test::VulkanHost other;
  if (!host->sharesSignals()) GTEST_SKIP() << "the device shares no binary semaphores as sync files";
  const XrdsTimelinePoint before{host->timeline(), 1}, after{host->timeline(), 1}, done{other.timeline(), 1};
  Frame mine = frame();
  prepare(mine);
  const std::vector<float> wanted = expected();
  std::memset(mine.output.memory.bytes, 0, 64);
  host->importSignal(other.exportSignal(), before);
  ASSERT_EQ(xrdsSubmit(mine.recording, &before, 1, &after, 1), XRDS_OK) << xrdsGetMessage();
  other.importSignal(host->exportSignal(after), done);
  other.await(done);
  EXPECT_EQ(get(mine.output), wanted);
}

// The colour and the result are in memory of another device of the GPU, which the host imports by file descriptors.
TEST_F(Embedded, TakesMemoryOfAnotherDevice) {
  test::VulkanHost other;
  Frame mine = frame();
  const uint64_t sizes[] = {12 * pixels[0].size() / 3, 12 * pixels[1].size() / 3};
  int descriptors[2] = {-1, -1};
  const test::HostBuffer theirs[] = {other.exported(sizes[0], descriptors[0]),
                                     other.exported(sizes[1], descriptors[1])};
  if (descriptors[0] < 0) GTEST_SKIP() << "the device shares no memory by file descriptor";
  std::memcpy(theirs[0].bytes, pixels[0].data(), sizes[0]);
  std::memset(theirs[1].bytes, 0, sizes[1]);
  mine.frame.colour.buffer = host->imported(sizes[0], descriptors[0]).buffer;
  mine.frame.output.buffer = host->imported(sizes[1], descriptors[1]).buffer;
  std::memset(mine.colour.memory.bytes, 0, sizes[0]);
  run(mine);
  std::vector<float> found(pixels[1].size());
  std::memcpy(found.data(), theirs[1].bytes, sizes[1]);
  EXPECT_EQ(found, expected());
}

}  // namespace
}  // namespace xrds
