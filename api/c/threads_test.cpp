// Threads that do as they like with the C API; the thread sanitizer has more to say of them.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/c_api.h"

namespace xrds {
namespace {

using namespace test;

// Calls `action` of a number in as many threads.
template <class Action>
void inThreads(int count, const Action& action) {
  std::vector<std::thread> threads;
  threads.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) threads.emplace_back([&action, i] { action(i); });
  for (std::thread& thread : threads) thread.join();
}

// Each opens everything for itself, is refused something, and hears of that alone.
TEST_F(CApi, ThreadsOpenDevicesOfTheirOwn) {
  const std::vector<float> wanted = expected();
  inThreads(3, [&](int number) {
    const std::string name = "none-" + std::to_string(number);
    for (int again = 0; again < 2; ++again) {
      uint32_t count = 0;
      EXPECT_EQ(xrdsCountDevices(&count), XRDS_OK) << xrdsGetMessage();
      XrdsDevice* ownDevice = nullptr;
      XrdsModel *ownModel = nullptr, *none = nullptr;
      XrdsUpscaler* own = nullptr;
      EXPECT_EQ(xrdsOpenModel(name.c_str(), &none), XRDS_ERROR_FAILED);
      ASSERT_EQ(xrdsOpenDevice(nullptr, &ownDevice), XRDS_OK) << xrdsGetMessage();
      ASSERT_EQ(xrdsOpenModel(kModel.c_str(), &ownModel), XRDS_OK) << xrdsGetMessage();
      ASSERT_EQ(xrdsCreateUpscaler(ownDevice, ownModel, kWidth, kHeight, nullptr, &own), XRDS_OK) << xrdsGetMessage();
      std::vector<float> pixels(wanted.size());
      const XrdsImage picture = rgb(pixels, kWide, kHigh);
      EXPECT_EQ(xrdsUpscale(own, &colour, auxiliary, 2, &picture, nullptr, nullptr), XRDS_OK) << xrdsGetMessage();
      EXPECT_EQ(pixels, wanted);
      EXPECT_NE(std::string(xrdsGetMessage()).find(name), std::string::npos) << xrdsGetMessage();
      xrdsCloseDevice(ownDevice);
      xrdsDestroyUpscaler(own);
      xrdsCloseModel(ownModel);
    }
  });
}

// One runs it, the others are refused: nothing is mixed up.
TEST_F(CApi, ThreadsAtOneUpscalerAreRefusedOrServed) {
  const std::vector<float> wanted = expected();
  std::atomic<int> served = 0;
  inThreads(3, [&](int) {
    std::vector<float> pixels(wanted.size());
    const XrdsImage picture = rgb(pixels, kWide, kHigh);
    for (int frame = 0; frame < 4; ++frame) {
      const XrdsResult result = xrdsUpscale(upscaler, &colour, auxiliary, 2, &picture, nullptr, nullptr);
      ASSERT_TRUE(result == XRDS_OK || result == XRDS_ERROR_BUSY) << xrdsGetMessage();
      xrdsGetExposure(upscaler);
      xrdsGetDeviceBytes(upscaler);
      if (result != XRDS_OK) continue;
      ++served;
      EXPECT_EQ(pixels, wanted);
    }
  });
  EXPECT_GT(served, 0);
}

// What a thread is at stays until it is done; its next call is refused.
TEST_F(CApi, ThreadsLoseWhatAnotherOneCloses) {
  const std::vector<float> wanted = expected();
  std::atomic<int> heard = 0;
  const auto hear = [](void* user, double) {
    ++*static_cast<std::atomic<int>*>(user);
    return 1;
  };
  std::thread other([&] {
    while (heard == 0) std::this_thread::yield();
    xrdsCloseDevice(device);
    xrdsCloseModel(model);
    xrdsDestroyUpscaler(upscaler);
  });
  int frames = 0;
  XrdsResult result = XRDS_OK;
  for (; result == XRDS_OK && frames < 100'000; ++frames) {
    result = run(hear, &heard);
    if (result == XRDS_OK) {
      EXPECT_EQ(outputPixels, wanted);
    }
  }
  other.join();
  EXPECT_GT(frames, 1);
  EXPECT_EQ(result, XRDS_ERROR_ARGUMENT);
  EXPECT_STREQ(xrdsGetMessage(), "The upscaler is not open: it was closed, or is no handle at all.");
  EXPECT_EQ(run(), XRDS_ERROR_ARGUMENT);
}

}  // namespace
}  // namespace xrds
