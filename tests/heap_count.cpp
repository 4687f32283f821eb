#include "tests/heap_count.h"

#include <cstdlib>
#include <new>
#if defined(_WIN32)
#include <malloc.h>
#endif

namespace {

thread_local bool counting = false;
thread_local int uncounted = 0;
thread_local size_t allocations = 0;

// Windows has no std::aligned_alloc(), and aligned memory of its own goes back by a function of its own.
void* alignedMemory(std::size_t size, std::size_t alignment) {
#if defined(_WIN32)
  return _aligned_malloc(size, alignment);
#else
  return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
#endif
}

void freeAligned(void* memory) {
#if defined(_WIN32)
  _aligned_free(memory);
#else
  std::free(memory);
#endif
}

void* allocate(std::size_t size, std::size_t alignment) {
  if (counting && uncounted == 0) ++allocations;
  void* const memory = alignment > 0 ? alignedMemory(size, alignment) : std::malloc(size > 0 ? size : 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}

void* allocateOrNot(std::size_t size, std::size_t alignment) {
  try {
    return allocate(size, alignment);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

}  // namespace

// All other forms come down to these, but for a sanitizer's own, which has those without an exception.
void* operator new(std::size_t size) { return allocate(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return allocateOrNot(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return allocateOrNot(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { freeAligned(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { freeAligned(memory); }

namespace xrds::test {

HeapCount::HeapCount() {
  ::allocations = 0;
  counting = true;
}
HeapCount::~HeapCount() { counting = false; }
size_t HeapCount::allocations() const { return ::allocations; }

Uncounted::Uncounted() { ++uncounted; }
Uncounted::~Uncounted() { --uncounted; }

}  // namespace xrds::test
