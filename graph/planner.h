#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace xrds {

/// When a value holds bytes: from the step that first writes it to the step that last reads it, both included.
struct Lifetime {
  uint32_t firstUse = 0, lastUse = 0;
  uint64_t byteSize = 0;
  uint64_t alignment = 256;
};

/// Where each value lies in one arena.
struct MemoryPlan {
  std::vector<uint64_t> offsets;  // of each value in the arena
  uint64_t byteSize = 0;          // of the arena
};

/// Places values so that no two that live at the same step share bytes, in as few bytes as it finds. Pure and
/// deterministic; values of size 0 get offset 0.
MemoryPlan planMemory(std::span<const Lifetime> lifetimes);

/// The plan without aliasing: one value behind the other.
MemoryPlan planWithoutAliasing(std::span<const Lifetime> lifetimes);

/// The most bytes that live at one step: no plan can be smaller.
uint64_t largestLiveSet(std::span<const Lifetime> lifetimes);

}  // namespace xrds
