#include "engine/hazards.h"

namespace xrds {
namespace {

bool conflict(const RangeAccess& a, const RangeAccess& b) {
  return a.buffer == b.buffer && (a.access == Access::write || b.access == Access::write) &&
         a.byteOffset < b.byteOffset + b.byteSize && b.byteOffset < a.byteOffset + a.byteSize;
}

}  // namespace

std::vector<bool> barriersBefore(std::span<const std::vector<RangeAccess>> dispatches) {
  std::vector<bool> barriers;
  std::vector<RangeAccess> open;  // accesses since the last barrier
  for (const auto& accesses : dispatches) {
    bool needed = false;
    for (const auto& now : accesses)
      for (const auto& earlier : open) needed = needed || conflict(now, earlier);
    if (needed) open.clear();
    open.insert(open.end(), accesses.begin(), accesses.end());
    barriers.push_back(needed);
  }
  return barriers;
}

}  // namespace xrds
