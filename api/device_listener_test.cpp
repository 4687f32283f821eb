// What listeners of a device throw comes out of the call that they were called in.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "tests/temporary_folder.h"
#include "xrds/xrds.hpp"

namespace xrds {
namespace {

// While another thread's calls end well.
TEST(DeviceListener, ThrowsInTheThreadOfTheCall) {
  const test::TemporaryFolder cache;
  {
    bool refuses = false;
    Device::Options options{.cacheFolder = cache.path()};
    options.onPreparation = [&](const Preparation&) {
      if (refuses) throw std::runtime_error("no programs today");
      return true;
    };
    Device device(options);
    const Model model = Model::untrained(2, "bicubic");
    refuses = true;
    std::atomic<bool> ended = false;
    std::thread other([&] {
      while (!ended) EXPECT_NO_THROW(device.finish(XRDS_OK));
    });
    for (int i = 0; i < 20; ++i) {
      try {
        const Upscaler upscaler(device, model, 16, 8, {});
        ADD_FAILURE() << "not refused";
      } catch (const std::exception& error) {
        EXPECT_STREQ(error.what(), "no programs today");
      }
    }
    ended = true;
    other.join();
    refuses = false;
    EXPECT_NO_THROW(Upscaler(device, model, 16, 8, {}));
  }
}

// Whatever the device has to say while it is closed.
TEST(DeviceListener, LivesUntilItsDeviceIsClosed) {
  XrdsDevice* handle = nullptr;
  XrdsResult found = XRDS_OK;
  std::shared_ptr<void> listener(nullptr, [&](void*) {
    XrdsDeviceDescription description{.structSize = sizeof description};
    found = xrdsDescribeOpenDevice(handle, &description);
  });
  Device device({.onMessage = [held = std::exchange(listener, nullptr)](std::string_view) {}});
  handle = device.handle();
  device = Device();
  EXPECT_EQ(found, XRDS_ERROR_ARGUMENT) << "the device was still open";
}

TEST(DeviceListener, IsNotMissedByADeviceThatWasMovedAway) {
  Device device;
  const Device moved = std::move(device);
  const Model model = Model::untrained(2, "bicubic");
  EXPECT_THROW(Upscaler(device, model, 16, 8, {}), InvalidArgument);
  EXPECT_NO_THROW(moved.finish(XRDS_OK));
}

// A run that plans anew: with layers the memory holds tiles alone. At this size their programs are others, with vectors
// of 256 bits and of 512.
TEST(DeviceListener, ThrowsOutOfARun) {
  bool refuses = false;
  Device device({.onPreparation = [&](const Preparation&) {
    if (refuses) throw std::runtime_error("no programs today");
    return true;
  }});
  constexpr uint32_t kSide = 40, kLarge = 4 * kSide;
  const Model model(XRDS_GOLDEN_FOLDER "/s4_guided.model.safetensors");
  const Tiling whole = Upscaler(device, model, kSide, kSide, {}).tiling();
  Upscaler upscaler(device, model, kSide, kSide, {.tiles = {.memoryBytes = whole.arenaBytes + whole.weightBytes}});
  const std::vector<float> pixels(3 * kSide * kSide, 0.5F);
  const std::vector<float> guide(16 * pixels.size(), 0.5F);
  std::vector<float> output(guide.size()), light(guide.size());
  const PixelView colour{pixels.data(), kSide, kSide},
      auxiliary[] = {{guide.data(), kLarge, kLarge}, {guide.data(), kLarge, kLarge}};
  const LayerSet layers{.lights = {{.light = colour, .output = light}}};
  refuses = true;
  try {
    upscaler.run(colour, auxiliary, output, {&layers, 1});
    ADD_FAILURE() << "not refused";
  } catch (const std::exception& error) {
    EXPECT_STREQ(error.what(), "no programs today");
  }
  EXPECT_NO_THROW(device.finish(XRDS_OK)) << "it was thrown before";
  refuses = false;
  EXPECT_TRUE(upscaler.run(colour, auxiliary, output, {&layers, 1}));
}

}  // namespace
}  // namespace xrds
