#pragma once

#include <cstdint>
#include <span>

namespace xrds {

/// A SPIR-V module, or an instruction of one.
using SpirvWords = std::span<const uint32_t>;

inline constexpr uint32_t kSpirvHeaderWords = 5;

inline uint32_t operationOf(SpirvWords instruction) { return instruction[0] & 0xFFFF; }

/// Calls visit(SpirvWords) with the instructions of a module in order.
void forEachInstruction(SpirvWords module, auto&& visit) {
  for (size_t at = kSpirvHeaderWords; at < module.size() && module[at] >> 16 > 0; at += module[at] >> 16)
    visit(module.subspan(at, module[at] >> 16));
}

}  // namespace xrds
