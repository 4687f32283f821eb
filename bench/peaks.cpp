#include "bench/peaks.h"

#include <algorithm>
#include <cmath>

#include "bench/timing.h"
#include "peak_arithmetic.h"
#include "peak_arithmetic_apart.h"
#include "peak_copy.h"
#include "peak_copy_wide.h"
#include "peak_read.h"
#include "xrds/error.h"

namespace xrds::bench {
namespace {

constexpr uint32_t kGroupSize = 64;
constexpr int kRuns = 8;

std::vector<float> downloadFloats(const Buffer& buffer, size_t count) {
  std::vector<float> numbers(count);
  buffer.download(0, std::as_writable_bytes(std::span(numbers)));
  return numbers;
}

PlacedDispatch launch(const char* program, const Buffer& source, const Buffer& target, uint32_t invocations) {
  PlacedDispatch placed;
  placed.dispatch.program = program;
  placed.dispatch.bindings = {{0, Access::read, BindingKind::texel}, {1, Access::write, BindingKind::storage}};
  placed.dispatch.groupCount = {invocations / kGroupSize, 1, 1};
  placed.ranges = {{&source, 0, source.byteSize()}, {&target, 0, target.byteSize()}};
  return placed;
}

double bestSeconds(Gpu& gpu, const PlacedDispatch& placed) {
  TimedRecording recording(gpu, {&placed, 1});
  recording.run();  // compiles
  double best = recording.run();
  for (int i = 1; i < kRuns; ++i) best = std::min(best, recording.run());
  return best;
}

double peakFlops(Gpu& gpu, const char* program) {
  constexpr uint32_t kInvocations = 1 << 18, kSteps = 64, kChains = 12;
  constexpr double kLongEnough = 0.03;
  Buffer source(gpu, kBindingAlignment), target(gpu, uint64_t{kInvocations} * 16);
  std::vector<float> numbers(kBindingAlignment / 4, 1);  // start
  std::fill_n(numbers.begin(), 4, -2.0F);                // scale
  source.upload(0, std::as_bytes(std::span(numbers)));
  PlacedDispatch placed = launch(program, source, target, kInvocations);
  placed.dispatch.specialization = {kSteps};
  for (uint32_t loops = 4;; loops *= 2) {
    placed.dispatch.pushConstants = pushBytes(loops);
    const double seconds = bestSeconds(gpu, placed);
    for (const float number : downloadFloats(target, size_t{kInvocations} * 4))
      if (!(std::abs(number - 1) < 1e-5F)) throw Error("The arithmetic that measures the device's peak went wrong.");
    if (seconds > kLongEnough || loops > (1U << 20)) return 2.0 * kInvocations * kChains * kSteps * loops / seconds;
  }
}

/// A kernel that reads and writes so many bytes an invocation, and leaves ones of ones.
struct Mover {
  const char* program;
  uint32_t readBytes, writtenBytes;
};

double peakBytesPerSecond(Gpu& gpu, const Mover& mover, uint64_t largest) {
  const DeviceTraits& traits = gpu.traits();
  constexpr uint64_t kUnit = uint64_t{1} << 20;
  const uint64_t most = std::min({largest, traits.maxStorageBufferRange, traits.maxTexelBufferElements * 16,
                                  uint64_t{65535} * kGroupSize * mover.readBytes});
  Buffer source(gpu, most / kUnit * kUnit), target(gpu, source.byteSize() / mover.readBytes * mover.writtenBytes);
  source.fill(0x3F800000);  // 1.0
  target.fill(0);
  const auto invocations = static_cast<uint32_t>(source.byteSize() / mover.readBytes);
  PlacedDispatch placed = launch(mover.program, source, target, invocations);
  if (mover.readBytes > mover.writtenBytes) placed.dispatch.specialization = {mover.readBytes / 16};
  const double seconds = bestSeconds(gpu, placed);
  for (const float number : downloadFloats(target, target.byteSize() / 4))
    if (number != 1) throw Error("The kernel that measures how fast the device moves bytes went wrong.");
  return static_cast<double>(source.byteSize() + target.byteSize()) / seconds;
}

}  // namespace

std::span<const uint32_t> peakProgram(std::string_view name) {
  if (name == "peak_arithmetic") return peak_arithmetic;
  if (name == "peak_arithmetic_apart") return peak_arithmetic_apart;
  if (name == "peak_copy") return peak_copy;
  if (name == "peak_copy_wide") return peak_copy_wide;
  if (name == "peak_read") return peak_read;
  return {};
}

DevicePeaks measurePeaks(Gpu& gpu) {
  constexpr uint64_t kLarge = uint64_t{128} << 20, kCached = uint64_t{8} << 20;
  std::vector<Mover> movers{{"peak_copy", 16, 16}, {"peak_read", 256, 16}};
  if (gpu.traits().shaderInt64) movers.push_back({"peak_copy_wide", 32, 32});
  DevicePeaks peaks{.flops = std::max(peakFlops(gpu, "peak_arithmetic"), peakFlops(gpu, "peak_arithmetic_apart"))};
  for (const Mover& mover : movers)
    for (const uint64_t largest : {kLarge, kCached})
      if (largest == kLarge || gpu.traits().memoryBytes == 0)
        peaks.bytesPerSecond = std::max(peaks.bytesPerSecond, peakBytesPerSecond(gpu, mover, largest));
  return peaks;
}

}  // namespace xrds::bench
