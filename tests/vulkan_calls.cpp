// The functions of a device that the host of the tests hands out: counted, and made to fail.
#if defined(_WIN32)
#include <windows.h>
#else
#include <dlfcn.h>
#endif

#include <array>
#include <atomic>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>
#include <stdexcept>

#include "tests/heap_count.h"
#include "tests/vulkan_host.h"

namespace xrds::test {
namespace {

enum Counted {
#define XRDS_INDEX(name) k_##name,
  XRDS_DEVICE_FUNCTIONS(XRDS_INDEX)
#undef XRDS_INDEX
      kCountedCount
};

constexpr const char* kNames[] = {
#define XRDS_NAME(name) #name,
    XRDS_DEVICE_FUNCTIONS(XRDS_NAME)
#undef XRDS_NAME
};

std::array<std::atomic<int>, kCountedCount> counts;
std::array<PFN_vkVoidFunction, kCountedCount> originals;

std::atomic<int> failing = -1;
std::atomic<VkResult> failure;

std::mutex memoryAccess;
std::map<VkDeviceMemory, uint64_t> memories;  // of the library, with their bytes
constexpr uint64_t kNoLimit = std::numeric_limits<uint64_t>::max();
uint64_t mostBytes = kNoLimit;  // of all of them

uint64_t heldBytes() {
  return std::accumulate(memories.begin(), memories.end(), uint64_t{0},
                         [](uint64_t sum, const auto& memory) { return sum + memory.second; });
}

// The driver's vkAllocateMemory() and vkFreeMemory(), by the limit.
VkResult allocate(PFN_vkAllocateMemory next, VkDevice device, const VkMemoryAllocateInfo* info,
                  const VkAllocationCallbacks* allocator, VkDeviceMemory* memory) {
  const std::lock_guard lock(memoryAccess);
  if (heldBytes() + info->allocationSize > mostBytes) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  const VkResult result = next(device, info, allocator, memory);
  if (result == VK_SUCCESS) memories[*memory] = info->allocationSize;
  return result;
}

void release(PFN_vkFreeMemory next, VkDevice device, VkDeviceMemory memory, const VkAllocationCallbacks* allocator) {
  const std::lock_guard lock(memoryAccess);
  memories.erase(memory);
  next(device, memory, allocator);
}

template <Counted kIndex, class Function>
struct Thunk;
template <Counted kIndex, class Result, class... Arguments>
struct Thunk<kIndex, Result(VKAPI_PTR*)(Arguments...)> {
  static VKAPI_ATTR Result VKAPI_CALL call(Arguments... arguments) {
    ++counts[kIndex];
    if constexpr (std::is_same_v<Result, VkResult>)
      if (failing == kIndex) return failure;
    const Uncounted driver;
    const auto next = reinterpret_cast<Result(VKAPI_PTR*)(Arguments...)>(originals[kIndex]);
    if constexpr (kIndex == k_vkAllocateMemory) return allocate(next, arguments...);
    if constexpr (kIndex == k_vkFreeMemory) return release(next, arguments...);
    return next(arguments...);
  }
};

PFN_vkGetDeviceProcAddr deviceLoader = nullptr;

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL countedDeviceFunction(VkDevice device, const char* name) {
#define XRDS_COUNTED(function)                                                               \
  if (std::strcmp(name, #function) == 0) {                                                   \
    originals[k_##function] = deviceLoader(device, name);                                    \
    return reinterpret_cast<PFN_vkVoidFunction>(&Thunk<k_##function, PFN_##function>::call); \
  }
  XRDS_DEVICE_FUNCTIONS(XRDS_COUNTED)
#undef XRDS_COUNTED
  return nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL countedLoader(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction found = VulkanHost::systemLoader()(instance, name);
  if (std::strcmp(name, "vkGetDeviceProcAddr") != 0) return found;
  deviceLoader = reinterpret_cast<PFN_vkGetDeviceProcAddr>(found);
  return reinterpret_cast<PFN_vkVoidFunction>(&countedDeviceFunction);
}

}  // namespace

PFN_vkGetInstanceProcAddr VulkanHost::systemLoader() {
#if defined(_WIN32)
  static const HMODULE library = LoadLibraryA("vulkan-1.dll");
  const auto find = [](const char* name) { return reinterpret_cast<void*>(GetProcAddress(library, name)); };
#else
  static void* const library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  const auto find = [](const char* name) { return dlsym(library, name); };
#endif
  if (!library) throw std::runtime_error("There is no Vulkan loader.");
  return reinterpret_cast<PFN_vkGetInstanceProcAddr>(find("vkGetInstanceProcAddr"));
}

PFN_vkGetInstanceProcAddr VulkanHost::loader() { return countedLoader; }

std::vector<std::pair<std::string, int>> VulkanHost::takeCalls() {
  std::vector<std::pair<std::string, int>> calls;
  for (size_t i = 0; i < counts.size(); ++i)
    if (const int count = counts[i].exchange(0)) calls.emplace_back(kNames[i], count);
  return calls;
}

void VulkanHost::fail(const char* function, VkResult result) {
  failure = result;
  failing = -1;
  for (int i = 0; i < kCountedCount && function; ++i)
    if (std::strcmp(kNames[i], function) == 0) failing = i;
}

void VulkanHost::limitMemory(std::optional<uint64_t> more) {
  const std::lock_guard lock(memoryAccess);
  mostBytes = more ? heldBytes() + *more : kNoLimit;
}

}  // namespace xrds::test
