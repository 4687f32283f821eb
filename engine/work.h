#pragma once

#include <algorithm>
#include <cstdint>

namespace xrds {

/// What a dispatch counts as where work is cut, in multiply-adds: writing bytes takes time, too.
constexpr uint64_t workOf(uint64_t multiplyAdds, uint64_t bytesWritten) {
  constexpr uint64_t kMultiplyAddsPerByte = 16;  // of lavapipe's image operators
  return std::max(multiplyAdds, kMultiplyAddsPerByte * bytesWritten);
}

}  // namespace xrds
