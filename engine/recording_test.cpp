#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "engine/handles.h"
#include "engine/work.h"
#include "tests/engine_programs.h"
#include "tests/harness.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using test::gpu;
using test::twicePlus;

constexpr uint32_t kQuads = 1000;
// Bytes, of which a tensor of kQuads takes 16000, and what is bound of it 1052672.
constexpr uint64_t kRegion = 2097152;

// A chain: region i + 1 = 2 region i + i, from region 0.
std::vector<PlacedDispatch> chain(const Buffer& buffer, uint32_t length) {
  std::vector<PlacedDispatch> dispatches;
  for (uint32_t i = 0; i < length; ++i)
    dispatches.push_back(twicePlus(buffer, i * kRegion, (i + 1) * kRegion, kQuads, i));
  return dispatches;
}

std::vector<float> chainByHost(std::vector<float> numbers, uint32_t length) {
  for (uint32_t i = 0; i < length; ++i)
    for (float& number : numbers) number = 2 * number + static_cast<float>(i);
  return numbers;
}

TEST(Recording, OrdersADispatchAfterTheOneItReads) {
  Buffer buffer(gpu(), 3 * kRegion);
  const auto numbers = test::randomNumbers(kQuads * 4, 1);
  test::uploadFloats(buffer, 0, numbers);
  Recording recording(gpu(), chain(buffer, 2));
  EXPECT_EQ(recording.barrierCount(), 1u);
  EXPECT_TRUE(recording.run());
  EXPECT_EQ(test::downloadFloats(buffer, 2 * kRegion, kQuads * 4), chainByHost(numbers, 2));
}

TEST(Recording, IndependentDispatchesHaveNoBarrier) {
  Buffer buffer(gpu(), 4 * kRegion);
  const std::vector<PlacedDispatch> dispatches{twicePlus(buffer, 0, 1 * kRegion, kQuads, 1),
                                               twicePlus(buffer, 0, 2 * kRegion, kQuads, 2),
                                               twicePlus(buffer, 0, 3 * kRegion, kQuads, 3)};
  EXPECT_EQ(Recording(gpu(), dispatches).barrierCount(), 0u);
}

// The third dispatch writes bytes of the first one's source though no value joins them.
TEST(Recording, AliasingRangesAreOrdered) {
  Buffer buffer(gpu(), 3 * kRegion);
  test::uploadFloats(buffer, 0, std::vector<float>(kQuads * 4, 1));
  const std::vector<PlacedDispatch> dispatches{twicePlus(buffer, 0, kRegion, kQuads, 0),
                                               twicePlus(buffer, kRegion, 2 * kRegion, kQuads, 0),
                                               twicePlus(buffer, 2 * kRegion, 256, kQuads - 100, 0)};
  Recording recording(gpu(), dispatches);
  EXPECT_EQ(recording.barrierCount(), 2u);
  recording.run();
  EXPECT_EQ(test::downloadFloats(buffer, 0, 64), std::vector<float>(64, 1));
  EXPECT_EQ(test::downloadFloats(buffer, 256, (kQuads - 100) * 4), std::vector<float>((kQuads - 100) * 4, 8));
}

PlacedDispatch copied(const Buffer& buffer, uint64_t from, uint64_t to, uint64_t byteSize) {
  PlacedDispatch placed;
  placed.dispatch.program = "copy";
  placed.dispatch.bindings = {{.access = Access::read, .kind = BindingKind::copied},
                              {.access = Access::write, .kind = BindingKind::copied}};
  placed.ranges = {{&buffer, from, byteSize}, {&buffer, to, byteSize}};
  return placed;
}

// Between two kernels, at offsets that no descriptor could have.
TEST(Recording, OrdersACopyAmongDispatches) {
  Buffer buffer(gpu(), 5 * kRegion);
  const auto numbers = test::randomNumbers(kQuads * 4, 1);
  test::uploadFloats(buffer, 0, numbers);
  const std::vector<PlacedDispatch> dispatches{
      twicePlus(buffer, 0, kRegion, kQuads, 1),
      copied(buffer, kRegion + 4, 2 * kRegion + 20, 400),
      twicePlus(buffer, 2 * kRegion, 3 * kRegion, kQuads, 0),
      twicePlus(buffer, 0, 2 * kRegion, kQuads, 3),
  };
  Recording recording(gpu(), dispatches, {.timestamps = true});
  EXPECT_EQ(recording.barrierCount(), 3u);
  for (int run = 0; run < 2; ++run) {
    EXPECT_TRUE(recording.run());
    const auto result = test::downloadFloats(buffer, 3 * kRegion, kQuads * 4);
    for (size_t i = 0; i < 100; ++i) ASSERT_EQ(result[i + 5], 2 * (2 * numbers[i + 1] + 1)) << i;
  }
  EXPECT_EQ(recording.gpuMicroseconds().size(), dispatches.size());
}

TEST(Recording, RefusesACopyOfUnequalSizes) {
  Buffer buffer(gpu(), 2 * kRegion);
  PlacedDispatch placed = copied(buffer, 0, kRegion, 400);
  placed.ranges[1].byteSize = 404;
  EXPECT_THROW(Recording(gpu(), {&placed, 1}), std::logic_error);
}

// Says of the first dispatch that it only reads what it writes: then no barrier is recorded, which
// synchronization validation must notice, or it guards nothing here.
TEST(Recording, ValidationNoticesAMissingBarrier) {
  if (std::getenv("XRDS_TEST_NO_VALIDATION")) GTEST_SKIP() << "validation is off";
  Buffer buffer(gpu(), 3 * kRegion);
  auto dispatches = chain(buffer, 2);
  dispatches[0].dispatch.bindings[1].access = Access::read;
  Recording recording(gpu(), dispatches);
  EXPECT_EQ(recording.barrierCount(), 0u);
  const auto messages = test::takeMessages();
  ASSERT_FALSE(messages.empty());
  EXPECT_NE(messages[0].find("READ_AFTER_WRITE"), std::string::npos) << messages[0];
}

TEST(Recording, ReplaysOnNewContents) {
  Buffer buffer(gpu(), 3 * kRegion);
  Recording recording(gpu(), chain(buffer, 2));
  for (uint32_t seed = 1; seed < 4; ++seed) {
    const auto numbers = test::randomNumbers(kQuads * 4, seed);
    test::uploadFloats(buffer, 0, numbers);
    recording.run();
    EXPECT_EQ(test::downloadFloats(buffer, 2 * kRegion, kQuads * 4), chainByHost(numbers, 2));
  }
}

TEST(Recording, ManySubmissionsGiveTheSameBits) {
  constexpr uint32_t kLength = 20;
  Buffer buffer(gpu(), (kLength + 1) * kRegion);
  const auto numbers = test::randomNumbers(kQuads * 4, 1);
  std::vector<std::vector<float>> results;
  for (const uint64_t multiplyAdds : {uint64_t{1}, 3 * workOf(kQuads * 4, kQuads * 16), uint64_t{1} << 40}) {
    buffer.fill(~0u);
    test::uploadFloats(buffer, 0, numbers);
    Recording recording(gpu(), chain(buffer, kLength), {.multiplyAddsPerSubmission = multiplyAdds});
    size_t total = 0;
    recording.run([&total](size_t, size_t submissions) {
      total = submissions;
      return true;
    });
    EXPECT_EQ(total, multiplyAdds == 1 ? kLength : (multiplyAdds < (1u << 30) ? 7 : 1));
    results.push_back(test::downloadFloats(buffer, kLength * kRegion, kQuads * 4));
  }
  EXPECT_EQ(results[0], chainByHost(numbers, kLength));
  EXPECT_EQ(results[1], results[0]);
  EXPECT_EQ(results[2], results[0]);
}

TEST(Recording, ProgressStopsTheRun) {
  Buffer buffer(gpu(), 11 * kRegion);
  Recording recording(gpu(), chain(buffer, 10), {.timestamps = true, .multiplyAddsPerSubmission = 1});
  std::vector<size_t> finished;
  EXPECT_FALSE(recording.run([&finished](size_t done, size_t total) {
    EXPECT_EQ(total, 10u);
    finished.push_back(done);
    return done < 3;
  }));
  EXPECT_EQ(finished, (std::vector<size_t>{1, 2, 3}));
  EXPECT_TRUE(recording.gpuMicroseconds().empty());
  EXPECT_TRUE(recording.run());
}

// However busy the machine: the one lies within the other.
TEST(Recording, TimestampsFitIntoTheWallTime) {
  Buffer buffer(gpu(), 4 * kRegion);
  Recording recording(gpu(), chain(buffer, 3),
                      {.timestamps = true, .multiplyAddsPerSubmission = 2 * workOf(kQuads * 4, kQuads * 16)});
  for (int round = 0; round < 2; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    recording.run();
    const std::chrono::duration<double, std::micro> wall = std::chrono::steady_clock::now() - begin;
    const auto microseconds = recording.gpuMicroseconds();
    if (microseconds.empty()) GTEST_SKIP() << "the device has no timestamps";
    ASSERT_EQ(microseconds.size(), 3u);
    double sum = 0;
    for (const double each : microseconds) {
      EXPECT_GT(each, 0);
      sum += each;
    }
    EXPECT_LE(sum, wall.count());
  }
  EXPECT_TRUE(Recording(gpu(), chain(buffer, 1)).gpuMicroseconds().empty());
}

TEST(Recording, SizeZeroReachesToTheEndOfTheBuffer) {
  Buffer source(gpu(), 256), target(gpu(), 512);
  test::uploadFloats(source, 0, std::vector<float>(64, 3));
  PlacedDispatch placed = twicePlus(target, 0, 256, 16, 1);
  placed.ranges[0] = {&source, 0, 0};
  placed.ranges[1].byteSize = 0;
  Recording(gpu(), {&placed, 1}).run();
  EXPECT_EQ(test::downloadFloats(target, 256, 64), std::vector<float>(64, 7));
}

TEST(Recording, RefusesWhatBreaksALimit) {
  Buffer buffer(gpu(), 2 * kRegion);
  const auto refused = [&buffer](const std::function<void(PlacedDispatch&)>& spoil) {
    PlacedDispatch placed = twicePlus(buffer, 0, kRegion, kQuads, 0);
    spoil(placed);
    EXPECT_THROW(Recording(gpu(), {&placed, 1}), std::logic_error);
  };
  refused([](auto& p) { p.dispatch.program = "no such program"; });
  refused([](auto& p) { p.dispatch.groupCount[0] = 0; });
  refused([](auto& p) { p.dispatch.groupCount[2] = ~0u; });
  refused([](auto& p) { p.dispatch.pushConstants.resize(132); });
  refused([](auto& p) { p.dispatch.bindings.pop_back(); });
  refused([](auto& p) { p.ranges[0].byteOffset = 16; });
  refused([](auto& p) { p.ranges[0].byteSize = 24; });
  refused([](auto& p) { p.ranges[1].byteSize = kRegion + 4; });
  refused([](auto& p) { p.ranges[1].buffer = nullptr; });
  refused([](auto& p) { p.dispatch.bindings[0].access = Access::write; });
  EXPECT_THROW(Recording(gpu(), {}), std::logic_error);
}

// What was given up may still be running: nothing follows it, and nothing is recorded anew on top of it.
TEST(Recording, OfADeviceThatDidNotAnswerIsRefusedEverAfter) {
  Gpu lost(test::gpuOptions());
  Buffer buffer(lost, 3 * kRegion);
  test::uploadFloats(buffer, 0, test::randomNumbers(kQuads * 4, 1));
  Recording recording(lost, chain(buffer, 2));
  lost.setPatience(0);
  EXPECT_THROW(recording.run(), DeviceLost);
  lost.setPatience(kUsualPatienceSeconds);
  EXPECT_THROW(recording.run(), DeviceLost);
  EXPECT_THROW(Recording(lost, chain(buffer, 2)).run(), DeviceLost);
}

PFN_vkWaitForFences waitOfTheDriver = nullptr;
int waitsWithoutMemory = 0;

VKAPI_ATTR VkResult VKAPI_CALL waitOrLackMemory(VkDevice device, uint32_t count, const VkFence* fences, VkBool32 all,
                                                uint64_t nanoseconds) {
  if (waitsWithoutMemory-- > 0) return VK_ERROR_OUT_OF_HOST_MEMORY;
  return waitOfTheDriver(device, count, fences, all, nanoseconds);
}

// Nothing is known of the work then: it is waited for again, and as long as of a device that does not answer.
TEST(Recording, WaitsAgainWhereAWaitLackedMemory) {
  for (const bool recovers : {true, false}) {
    Gpu device(test::gpuOptions());
    Buffer buffer(device, 3 * kRegion);
    test::uploadFloats(buffer, 0, test::randomNumbers(kQuads * 4, 1));
    Recording recording(device, chain(buffer, 2));
    device.setPatience(2);
    waitOfTheDriver = device.handles().vk.vkWaitForFences;
    device.handles().vk.vkWaitForFences = &waitOrLackMemory;
    waitsWithoutMemory = recovers ? 1 : 2;
    if (recovers)
      EXPECT_TRUE(recording.run());
    else
      EXPECT_THROW(recording.run(), DeviceLost);
    EXPECT_EQ(device.handles().abandoned, !recovers);
    waitsWithoutMemory = 0;
  }
}

VKAPI_ATTR VkResult VKAPI_CALL waitAndLose(VkDevice device, uint32_t count, const VkFence* fences, VkBool32, uint64_t) {
  static_cast<void>(waitOfTheDriver(device, count, fences, VK_TRUE, UINT64_MAX));  // what is destroyed is not in use
  return VK_ERROR_DEVICE_LOST;
}

VKAPI_ATTR VkResult VKAPI_CALL loseSubmission(VkQueue, uint32_t, const VkSubmitInfo*, VkFence) {
  return VK_ERROR_DEVICE_LOST;
}

// Even if its driver takes more: a copy or a dispatch of it may do nothing, or be taken for done before it is.
TEST(Recording, OfADeviceThatWasLostIsRefusedEverAfter) {
  for (const bool waits : {true, false}) {
    Gpu lost(test::gpuOptions());
    Buffer buffer(lost, 3 * kRegion);
    Recording recording(lost, chain(buffer, 2));
    VolkDeviceTable& vk = lost.handles().vk;
    const VolkDeviceTable whole = vk;
    waitOfTheDriver = vk.vkWaitForFences;
    if (waits)
      vk.vkWaitForFences = &waitAndLose;
    else
      vk.vkQueueSubmit = &loseSubmission;
    EXPECT_THROW(recording.run(), DeviceLost);
    vk = whole;
    EXPECT_THROW(recording.run(), DeviceLost);
    EXPECT_THROW(Recording(lost, chain(buffer, 2)).run(), DeviceLost);
    EXPECT_THROW(buffer.fill(0), DeviceLost);
  }
}

// The buffer is only as large as the limit demands, and is never touched.
TEST(Recording, RefusesAStorageRangeBeyondTheLimit) {
  const uint64_t limit = gpu().traits().maxStorageBufferRange;
  if (limit > uint64_t{1} << 30) GTEST_SKIP() << "the limit is too large to try";
  Buffer buffer(gpu(), limit + 4);
  PlacedDispatch placed = twicePlus(buffer, 0, 0, 1, 0);
  placed.ranges[1].byteSize = limit + 4;
  EXPECT_THROW(Recording(gpu(), {&placed, 1}), std::logic_error);
  placed.ranges[0].byteSize = limit / 16 * 16;
  placed.ranges[1].byteSize = limit / 4 * 4;
  EXPECT_NO_THROW(Recording(gpu(), {&placed, 1}));
}

}  // namespace
}  // namespace xrds
