// What cannot be at the doors of xrds_vulkan.h: an error, a sentence, and no harm.
#include <thread>

#include "tests/embedded.h"
#include "xrds/xrds_vulkan.hpp"

namespace xrds {
namespace {

using test::Embedded;
using test::kScale;
using test::rgb;
using test::VulkanHost;

class EmbeddedDoors : public Embedded {
 public:
  static void refused(XrdsResult result, const char* words) {
    EXPECT_EQ(result, XRDS_ERROR_ARGUMENT) << words;
    EXPECT_NE(std::string(xrdsGetMessage()).find(words), std::string::npos) << words << " in " << xrdsGetMessage();
  }
  // xrdsUpscaleLayers() of the fixture's pixels, with layers each of which is all of the colour.
  XrdsResult upscaleWithLayers(uint32_t count) {
    const uint32_t w = kScale * width, h = kScale * height;
    const XrdsImage colour = rgb(pixels[0], width, height), auxiliary[] = {rgb(pixels[1], w, h), rgb(pixels[2], w, h)};
    std::vector<float> picture(pixels[1].size()), light(picture.size());
    const XrdsImage output = rgb(picture, w, h);
    XrdsLayer layer = xrdsLayerDefault();
    layer.light = colour;
    layer.output = rgb(light, w, h);
    const std::vector<XrdsLayer> layers(count, layer);
    XrdsLayerSet set = xrdsLayerSetDefault();
    set.layerCount = count;
    set.layers = layers.data();
    return xrdsUpscaleLayers(upscaler, &colour, auxiliary, 2, &output, &set, 1, nullptr, nullptr, nullptr);
  }
  // That the frame still comes out right.
  void expectNoHarm() {
    Frame mine = frame();
    run(mine);
    EXPECT_EQ(get(mine.output), expected());
  }
};

TEST_F(EmbeddedDoors, RefuseDevicesThatCannotBe) {
  XrdsDevice* made = nullptr;
  const auto open = [&](const XrdsVulkanDevice& vulkan) { return xrdsOpenVulkanDevice(&vulkan, nullptr, &made); };
  XrdsVulkanDevice wrong = host->vulkan();
  refused(xrdsOpenVulkanDevice(nullptr, nullptr, &made), "'vulkan' is a null pointer");
  refused(xrdsOpenVulkanDevice(&wrong, nullptr, nullptr), "'device' is a null pointer");
  wrong.structSize = 4;
  refused(open(wrong), "structSize of 4");
  wrong = host->vulkan(), wrong.instance = VK_NULL_HANDLE;
  refused(open(wrong), "instance or the physical device is a null handle");
  wrong = host->vulkan(), wrong.device = VK_NULL_HANDLE;
  refused(open(wrong), "device or its queue is a null handle");
  wrong = host->vulkan(), wrong.queue = VK_NULL_HANDLE;
  refused(open(wrong), "device or its queue is a null handle");
  wrong = host->vulkan(), wrong.queueFamily = 17;
  refused(open(wrong), "Queue family 17 of the device has no compute queues");
  wrong = host->vulkan(), wrong.lockQueue = [](void*) {};
  refused(open(wrong), "one is a null pointer: give both or neither");
  XrdsVulkanFeatures small = host->features;
  small.structSize = sizeof small + 8;
  wrong = host->vulkan(), wrong.enabled = &small;
  refused(open(wrong), "structSize of 64");
  VulkanHost other;  // another program's device
  wrong = host->vulkan(), wrong.physicalDevice = other.physicalDevice;
  refused(open(wrong), "none of the instance's");
  XrdsDeviceOptions options = xrdsDeviceOptionsDefault();
  options.select = "0";
  wrong = host->vulkan();
  refused(xrdsOpenVulkanDevice(&wrong, &options, &made), "leave the option select NULL");
  XrdsVulkanFeatures features{};
  refused(xrdsGetVulkanFeatures(nullptr, host->instance, host->physicalDevice, &features), "structSize of 0");
  refused(xrdsGetVulkanFeatures(nullptr, host->instance, host->physicalDevice, nullptr), "'features' is a null");
  EXPECT_EQ(made, nullptr);
  expectNoHarm();
}

// One that knows nothing, of an instance that it did not make.
TEST_F(EmbeddedDoors, RefuseALoaderThatDoesNotKnowTheInstance) {
  const PFN_vkGetInstanceProcAddr knowsNothing = [](VkInstance, const char*) -> PFN_vkVoidFunction { return nullptr; };
  VkPhysicalDevice found = VK_NULL_HANDLE;
  refused(xrdsSelectVulkanDevice(knowsNothing, host->instance, nullptr, &found), "does not know the instance");
  EXPECT_EQ(found, VK_NULL_HANDLE);
  XrdsVulkanFeatures features{.structSize = sizeof features};
  refused(xrdsGetVulkanFeatures(knowsNothing, host->instance, host->physicalDevice, &features),
          "does not know the instance");
  XrdsVulkanDevice wrong = host->vulkan();
  wrong.loader = knowsNothing;
  XrdsDevice* made = nullptr;
  refused(xrdsOpenVulkanDevice(&wrong, nullptr, &made), "does not know the instance");
  EXPECT_EQ(made, nullptr);
  expectNoHarm();
}

TEST_F(EmbeddedDoors, RefuseFramesThatCannotBe) {
  XrdsRecording* made = nullptr;
  Frame good = frame();
  good.frame.auxiliary = good.images;
  const auto create = [&](const XrdsVulkanFrame& frame) { return xrdsCreateRecording(upscaler, &frame, &made); };
  refused(xrdsCreateRecording(upscaler, nullptr, &made), "'frame' is a null pointer");
  refused(xrdsCreateRecording(upscaler, &good.frame, nullptr), "'recording' is a null pointer");
  refused(xrdsCreateRecording(nullptr, &good.frame, &made), "The upscaler is a null pointer");
  XrdsVulkanFrame wrong = good.frame;
  wrong.structSize = 3;
  refused(create(wrong), "structSize of 3");
  wrong = good.frame, wrong.auxiliaryCount = 1;
  refused(create(wrong), "takes 2 auxiliary images, found 1");
  wrong = good.frame, wrong.auxiliary = nullptr;
  refused(create(wrong), "'auxiliary' is a null pointer");
  const auto colour = [&](const auto& change, const char* words) {
    wrong = good.frame;
    change(wrong.colour);
    refused(create(wrong), words);
  };
  colour([](XrdsVulkanImage& image) { image.structSize = 0; }, "structSize of 0");
  colour([](XrdsVulkanImage& image) { image.width = 15; }, "The colour image is 15 x 9 pixels, expected 14 x 9");
  colour([](XrdsVulkanImage& image) { image.format = static_cast<XrdsFormat>(5); }, "has the format 5");
  colour([](XrdsVulkanImage& image) { image.buffer = VK_NULL_HANDLE; }, "neither a buffer and an image");
  colour([](XrdsVulkanImage& image) { image.channelCount = 1; }, "has 1 channels, expected 3 or 4");
  colour([](XrdsVulkanImage& image) { image.offset = 2; }, "an offset of 2, expected a multiple of 4");
  colour([](XrdsVulkanImage& image) { image.rowPitch = 4; }, "a row pitch of 4 bytes, expected a multiple of 4");
  colour([](XrdsVulkanImage& image) { image.offset = 1 << 20; }, "was given, expected at least 1050088 from");
  colour([](XrdsVulkanImage& image) { image.offset = ~uint64_t{3}; }, "was given, expected at least");
  wrong = good.frame, wrong.output = good.colour.image;
  refused(create(wrong), "The output image is 14 x 9 pixels, expected 56 x 36");
  wrong = good.frame, wrong.exposure = good.colour.memory.buffer;
  refused(create(wrong), "computes its own");
  EXPECT_EQ(made, nullptr);
  expectNoHarm();
}

TEST_F(EmbeddedDoors, RefuseAnExposureBehindItsBuffer) {
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.exposure = 1;
  open(14, 9, options);
  Frame mine = frame();
  mine.frame.auxiliary = mine.images;
  mine.frame.exposure = mine.colour.memory.buffer;
  mine.frame.exposureOffset = ~uint64_t{3};
  XrdsRecording* made = nullptr;
  refused(xrdsCreateRecording(upscaler, &mine.frame, &made), "was given, expected at least");
  EXPECT_EQ(made, nullptr);
}

TEST_F(EmbeddedDoors, RefuseUpscalersThatCannotBeRecorded) {
  XrdsRecording* made = nullptr;
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.ensemble = 2;
  open(14, 9, options);
  Frame mine = frame();
  mine.frame.auxiliary = mine.images;
  refused(xrdsCreateRecording(upscaler, &mine.frame, &made), "An ensemble of 2 passes cannot be recorded");
  options = xrdsUpscalerOptionsDefault();
  options.skipBound = 0.01F;
  open(14, 9, options);
  refused(xrdsCreateRecording(upscaler, &mine.frame, &made), "create it without skipBound and keepUnchanged");
  XrdsDevice* own = nullptr;
  XrdsUpscaler* foreign = nullptr;
  ASSERT_EQ(xrdsOpenDevice(nullptr, &own), XRDS_OK) << xrdsGetMessage();
  ASSERT_EQ(xrdsCreateUpscaler(own, model, 14, 9, nullptr, &foreign), XRDS_OK) << xrdsGetMessage();
  refused(xrdsCreateRecording(foreign, &mine.frame, &made), "a device of the library's own");
  xrdsDestroyUpscaler(foreign);
  xrdsCloseDevice(own);
  EXPECT_EQ(made, nullptr);
}

TEST_F(EmbeddedDoors, RefuseRecordingsThatAreNotThere) {
  Frame mine = frame();
  prepare(mine);
  const VkCommandBuffer commands = host->begin();
  refused(xrdsRecord(nullptr, commands), "The recording is a null pointer");
  refused(xrdsRecord(mine.recording, VK_NULL_HANDLE), "'commandBuffer' is a null pointer");
  refused(xrdsSubmit(mine.recording, nullptr, 1, nullptr, 0), "'waits' is a null pointer");
  const XrdsTimelinePoint none{};
  refused(xrdsSubmit(mine.recording, nullptr, 0, &none, 1), "Semaphore 0 of 'signals' is a null handle");
  // The recording keeps what it is made of.
  xrdsDestroyUpscaler(upscaler);
  xrdsCloseDevice(device);
  ASSERT_EQ(xrdsRecord(mine.recording, commands), XRDS_OK) << xrdsGetMessage();
  host->end(commands);
  host->submit(commands);
  host->await();
  EXPECT_GT(get(mine.output)[0], 0);
  xrdsDestroyRecording(mine.recording);
  xrdsDestroyRecording(mine.recording);  // no harm
  refused(xrdsRecord(mine.recording, commands), "The recording is not open");
}

TEST_F(EmbeddedDoors, TellOfALostDeviceAndOfNoMemory) {
  Frame mine = frame();
  prepare(mine);
  XrdsRecording* made = nullptr;
  for (const char* function : {"vkCreateDescriptorPool", "vkAllocateDescriptorSets", "vkCreateCommandPool",
                               "vkAllocateCommandBuffers", "vkBeginCommandBuffer", "vkEndCommandBuffer"}) {
    VulkanHost::fail(function, VK_ERROR_OUT_OF_DEVICE_MEMORY);
    EXPECT_EQ(xrdsCreateRecording(upscaler, &mine.frame, &made), XRDS_ERROR_OUT_OF_MEMORY) << function;
    EXPECT_NE(std::string(xrdsGetMessage()).find(function), std::string::npos) << xrdsGetMessage();
  }
  VulkanHost::fail(nullptr, VK_SUCCESS);
  EXPECT_EQ(made, nullptr);
  expectNoHarm();
  VulkanHost::fail("vkQueueSubmit", VK_ERROR_DEVICE_LOST);
  EXPECT_EQ(xrdsSubmit(mine.recording, nullptr, 0, nullptr, 0), XRDS_ERROR_DEVICE_LOST);
  EXPECT_NE(std::string(xrdsGetMessage()).find("the device was lost"), std::string::npos) << xrdsGetMessage();
  VulkanHost::fail(nullptr, VK_SUCCESS);  // a driver that goes on
  EXPECT_EQ(xrdsSubmit(mine.recording, nullptr, 0, nullptr, 0), XRDS_ERROR_DEVICE_LOST);
}

// Planned for as many layers as the run before had, a frame is recorded without.
TEST_F(EmbeddedDoors, RecordBehindLayers) {
  ASSERT_EQ(upscaleWithLayers(1), XRDS_OK) << xrdsGetMessage();
  expectNoHarm();
}

TEST_F(EmbeddedDoors, RefuseLayersWhileARecordingLives) {
  Frame one = frame(), two = frame();
  prepare(one);
  prepare(two);
  for (const Frame* each : {&one, &two}) {
    refused(upscaleWithLayers(1), "part of a recording");
    xrdsDestroyRecording(each->recording);
  }
  EXPECT_EQ(upscaleWithLayers(1), XRDS_OK) << xrdsGetMessage();
  expectNoHarm();
  refused(upscaleWithLayers(1), "part of a recording");
}

TEST_F(EmbeddedDoors, TellOfAnUpscalerThatHasNoRoomForLayers) {
  VulkanHost::fail("vkAllocateMemory", VK_ERROR_OUT_OF_DEVICE_MEMORY);
  EXPECT_EQ(upscaleWithLayers(1), XRDS_ERROR_OUT_OF_MEMORY) << xrdsGetMessage();
  EXPECT_EQ(xrdsGetExposure(upscaler), 0);
  EXPECT_EQ(xrdsGetDeviceBytes(upscaler), 0u);
  XrdsSkipMap map{.structSize = sizeof map};
  EXPECT_EQ(xrdsGetSkipMap(upscaler, &map, nullptr, 0), XRDS_OK) << xrdsGetMessage();
  const XrdsHearProfile hear = [](void*, const XrdsProfileRow*) {};
  EXPECT_EQ(xrdsGetProfile(upscaler, hear, nullptr), XRDS_OK) << xrdsGetMessage();
  Frame mine = frame();
  mine.frame.auxiliary = mine.images;
  XrdsRecording* made = nullptr;
  EXPECT_EQ(xrdsCreateRecording(upscaler, &mine.frame, &made), XRDS_ERROR_OUT_OF_MEMORY) << xrdsGetMessage();
  EXPECT_EQ(made, nullptr);
  VulkanHost::fail(nullptr, VK_SUCCESS);
  expectNoHarm();
}

// Of an ensemble both sessions are planned for the layers, or none.
TEST_F(EmbeddedDoors, GoOnWithLayersAfterNoRoomForMore) {
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.ensemble = 8;
  open(14, 9, options);
  ASSERT_EQ(upscaleWithLayers(1), XRDS_OK) << xrdsGetMessage();
  VulkanHost::fail("vkAllocateMemory", VK_ERROR_OUT_OF_DEVICE_MEMORY);
  EXPECT_EQ(upscaleWithLayers(2), XRDS_ERROR_OUT_OF_MEMORY) << xrdsGetMessage();
  EXPECT_GT(xrdsGetDeviceBytes(upscaler), 0u);
  VulkanHost::fail(nullptr, VK_SUCCESS);
  EXPECT_EQ(upscaleWithLayers(1), XRDS_OK) << xrdsGetMessage();
}

TEST_F(EmbeddedDoors, OpenFromSeveralThreads) {
  const std::vector<float> wanted = expected();
  std::vector<Frame> frames{frame(), frame(), frame()};
  std::vector<VkCommandBuffer> commands{host->begin(), host->begin(), host->begin()};
  for (Frame& each : frames) each.frame.auxiliary = each.images;
  std::vector<std::thread> threads;
  for (Frame& each : frames)
    threads.emplace_back([this, &each] {
      ASSERT_EQ(xrdsCreateRecording(upscaler, &each.frame, &each.recording), XRDS_OK) << xrdsGetMessage();
    });
  for (std::thread& thread : threads) thread.join();
  for (size_t i = 0; i < frames.size(); ++i) {
    recordings.push_back(frames[i].recording);
    ASSERT_EQ(xrdsRecord(frames[i].recording, commands[i]), XRDS_OK);
    host->end(commands[i]);
    host->submit(commands[i]);
  }
  host->await();
  for (const Frame& each : frames) EXPECT_EQ(get(each.output), wanted);
}

// The lock of the queue is held around each use of it, and nowhere else.
TEST_F(EmbeddedDoors, LockTheQueue) {
  struct Lock {
    int held = 0, uses = 0;
  } lock;
  XrdsVulkanDevice vulkan = host->vulkan();
  vulkan.queueUser = &lock;
  vulkan.lockQueue = [](void* user) { EXPECT_EQ(static_cast<Lock*>(user)->held++, 0); };
  vulkan.unlockQueue = [](void* user) { --static_cast<Lock*>(user)->held, ++static_cast<Lock*>(user)->uses; };
  XrdsDevice* locked = nullptr;
  XrdsUpscaler* own = nullptr;
  ASSERT_EQ(xrdsOpenVulkanDevice(&vulkan, nullptr, &locked), XRDS_OK) << xrdsGetMessage();
  ASSERT_EQ(xrdsCreateUpscaler(locked, model, 14, 9, nullptr, &own), XRDS_OK) << xrdsGetMessage();
  Frame mine = frame();
  mine.frame.auxiliary = mine.images;
  ASSERT_EQ(xrdsCreateRecording(own, &mine.frame, &mine.recording), XRDS_OK) << xrdsGetMessage();
  EXPECT_GT(lock.uses, 0);
  const int before = lock.uses;
  ASSERT_EQ(xrdsSubmit(mine.recording, nullptr, 0, nullptr, 0), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(lock.uses, before + 1);
  EXPECT_EQ(lock.held, 0);
  host->await();
  EXPECT_EQ(get(mine.output), expected());
  xrdsDestroyRecording(mine.recording);
  xrdsDestroyUpscaler(own);
  xrdsCloseDevice(locked);
}

TEST_F(EmbeddedDoors, ThrowWhatAListenerThrows) {
  bool refuses = false;
  Device own = openVulkanDevice(host->vulkan(), {.onPreparation = [&](const Preparation&) {
                                  if (refuses) throw std::runtime_error("no programs today");
                                  return true;
                                }});
  const Model network(test::kModel);
  Upscaler made(own, network, 14, 9, {});
  Frame mine = frame();
  mine.frame.auxiliary = mine.images;
  refuses = true;
  try {
    FrameRecording(made, mine.frame);
    ADD_FAILURE() << "not refused";
  } catch (const std::exception& error) {
    EXPECT_STREQ(error.what(), "no programs today");
  }
  EXPECT_NO_THROW(own.finish(XRDS_OK)) << "it was thrown before";
  refuses = false;
  EXPECT_NO_THROW(FrameRecording(made, mine.frame));
}

TEST_F(EmbeddedDoors, DoWithoutACacheFolder) {
  XrdsDeviceOptions options = xrdsDeviceOptionsDefault();
  options.cacheFolder = "/proc/none";
  const XrdsVulkanDevice vulkan = host->vulkan();
  XrdsDevice* other = nullptr;
  ASSERT_EQ(xrdsOpenVulkanDevice(&vulkan, &options, &other), XRDS_OK) << xrdsGetMessage();
  xrdsCloseDevice(other);
  options.kernelFamily = "none";
  EXPECT_EQ(xrdsOpenVulkanDevice(&vulkan, &options, &other), XRDS_ERROR_ARGUMENT);
  EXPECT_NE(std::string(xrdsGetMessage()).find("plain"), std::string::npos) << xrdsGetMessage();
}

}  // namespace
}  // namespace xrds
