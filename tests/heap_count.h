#pragma once

#include <cstddef>

namespace xrds::test {

/// Allocations by operator new of this thread since it began to count, but for those of callees that are not counted.
class HeapCount {
 public:
  HeapCount();
  ~HeapCount();
  HeapCount(const HeapCount&) = delete;
  HeapCount& operator=(const HeapCount&) = delete;
  size_t allocations() const;
};

/// Lets what is called meanwhile allocate uncounted: a driver, a layer.
class Uncounted {
 public:
  Uncounted();
  ~Uncounted();
  Uncounted(const Uncounted&) = delete;
  Uncounted& operator=(const Uncounted&) = delete;
};

}  // namespace xrds::test
