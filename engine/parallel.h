#pragma once

#include <cstdint>
#include <functional>

namespace xrds {

/// Calls work(begin, end) for consecutive parts that make up [0, count), of at least `least` each where there are
/// several, on as many threads as the processor has, one of which is the caller's; at most eight, for more copy no
/// faster. Nothing is called for a count of 0. Returns when all have ended; throws what one of them threw.
void inParallel(uint64_t count, uint64_t least, const std::function<void(uint64_t begin, uint64_t end)>& work);

}  // namespace xrds
