#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/dispatch.h"

namespace xrds {

/// One access of a dispatch to bytes of a buffer; buffers are told apart by any number.
struct RangeAccess {
  uint64_t buffer = 0, byteOffset = 0, byteSize = 0;
  Access access = Access::read;
};

/// For each dispatch, whether a barrier must stand before it: it touches bytes that a dispatch since the last barrier
/// wrote, or writes bytes that one has read. Hazards live on bytes, not on tensors. Pure.
std::vector<bool> barriersBefore(std::span<const std::vector<RangeAccess>> dispatches);

}  // namespace xrds
