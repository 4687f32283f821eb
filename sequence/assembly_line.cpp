#include "sequence/assembly_line.h"

#include <algorithm>

namespace xrds {

LineThreads threadsFor(size_t workers, size_t cores) {
  const size_t sides = std::clamp<size_t>(cores / 4, 1, 4);
  return {.readers = sides, .workers = std::max<size_t>(workers, 1), .writers = sides};
}

}  // namespace xrds
