#pragma once

#include <numeric>

#include "engine/dispatch.h"

namespace xrds {

/// Push constants of a kernel that includes uniform_store.glsl: the parameters, then its table of digits, of which
/// there are 4 with SMALL_DIGITS.
template <size_t kDigits = 16, class T>
std::vector<std::byte> pushBytesWithDigits(const T& parameters) {
  struct {
    T parameters;
    std::array<uint32_t, kDigits> digits;
  } push{parameters, {}};
  std::iota(push.digits.begin(), push.digits.end(), 0u);
  return pushBytes(push);
}

/// Whether a lane kernel reads its weights by address (shaders/common/lane_weights.glsl), by the types of its output
/// and of the weights.
inline bool readsWeightsByAddress(const DeviceTraits& device, DataType output, DataType weights) {
  return device.bufferAddresses && device.laneCode == LaneCode::scalars && output == DataType::f32 &&
         weights == DataType::f32;
}

/// Makes the launch of a lane kernel one of its form that does.
inline void readWeightsByAddress(Dispatch& launch) {
  launch.program += "_addressed";
  launch.weightsByAddress = true;
}

/// Subgroups of a workgroup when `count` of them are shared out evenly: `limit`, 4 or 1. Each number is a program of
/// its own, and with more of them every other frame size would compile some.
inline uint32_t subgroupShare(uint64_t count, uint32_t limit) {
  return count % limit == 0 ? limit : count % 4 == 0 ? 4 : 1;
}

/// KernelShape::rows of a lane kernel whose subgroups may take turns.
constexpr uint32_t kAtOnce = 1, kInTurns = 2;

/// Whether it pays that the subgroups of a workgroup take turns with long code, so that it is read from the instruction
/// cache. AVX2 reads a weight by an instruction of its own, so its code is longer than that of AVX-512.
inline bool gainsByTurns(const DeviceTraits& device) {
  constexpr uint32_t kLanes = 8;
  return device.subgroupSize == kLanes;
}

/// The same for `subgroups` whose lanes each hold `inputs` numbers. Where all of them take more than a seventh of the
/// second-level cache, those that wait for their turn leave it, which is worse: measured with 512 KiB and 1 MiB.
inline bool gainsByTurns(const DeviceTraits& device, uint32_t subgroups, uint32_t inputs) {
  constexpr uint64_t kShare = 7;
  return gainsByTurns(device) &&
         kShare * subgroups * device.subgroupSize * inputs * byteSize(DataType::f32) <= device.secondCacheBytes;
}

/// The largest divisor of `count` up to `limit`.
inline uint32_t evenShare(uint64_t count, uint32_t limit) {
  while (count % limit != 0) --limit;
  return limit;
}

}  // namespace xrds
