#pragma once

#include <cstdint>
#include <optional>

namespace xrds {

/// Forgets the largest resident memory of this process, so that the next peak is that of what comes now. Returns false
/// where the system cannot do that: it is Linux's.
bool resetPeakMemory();

/// The largest resident memory since the last reset, in bytes; nothing where the system does not tell.
std::optional<uint64_t> peakMemory();

}  // namespace xrds
