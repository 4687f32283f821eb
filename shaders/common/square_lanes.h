#pragma once

#include <optional>

#include "shaders/common/uniform_store.h"
#include "shaders/common/winograd.h"

namespace xrds {

/// How the lane kernels of Winograd's transforms share a row of squares: a lane takes a quad of channels of a square.
struct SquareLanes {
  uint32_t subgroups = 1;   // of a workgroup
  uint32_t workgroups = 1;  // of a row
};

/// For a row of so many squares of `quads` each; none where the device lacks what the kernels need. No two subgroups
/// make the same: a residual in the target's place would be added twice.
inline std::optional<SquareLanes> squareLanes(uint32_t squares, uint32_t quads, const DeviceTraits& device) {
  constexpr uint32_t kMostSubgroups = 8;  // of a workgroup
  const uint32_t items = squares * quads;
  if (device.family != KernelFamily::lane || !device.shaderInt64 || items > shader::kMostRowItems ||
      device.subgroupSize * kMostSubgroups > device.maxGroupInvocations)
    return std::nullopt;
  const uint32_t chunks = ceilDivide(items, device.subgroupSize), subgroups = subgroupShare(chunks, kMostSubgroups);
  return SquareLanes{subgroups, chunks / subgroups};
}

}  // namespace xrds
