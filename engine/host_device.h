#pragma once

#include <volk.h>

#include "engine/buffer.h"

namespace xrds {

/// What a program that has a Vulkan device of its own may enable for the engine, or has enabled: every bit is optional,
/// without it slower kernels run.
struct HostFeatures {
  bool shaderInt64 = false;  // with shaderSubgroupExtendedTypes
  bool subgroupSizeControl = false, computeFullSubgroups = false, shaderFloat16 = false, vulkanMemoryModel = false;
  bool cooperativeMatrixKhr = false, cooperativeMatrixNv = false;
};

/// A Vulkan 1.2 device of a program that shares it with the engine, and which outlives the engine's use of it.
struct HostDevice {
  PFN_vkGetInstanceProcAddr loader = nullptr;  // null: that of the system's loader
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  uint32_t queueFamily = 0;
  VkQueue queue = VK_NULL_HANDLE;
  HostFeatures enabled{};
  /// Called around each use of the queue; empty: the program does not use it meanwhile.
  std::function<void()> lockQueue{}, unlockQueue{};
};

/// An image of that program, of four floats or halves a pixel: its first layer and level.
struct HostImage {
  VkImage image = VK_NULL_HANDLE;
  VkImageLayout layout = VK_IMAGE_LAYOUT_GENERAL;  // before and behind each use
  uint32_t width = 0, height = 0;
};

/// A buffer of that program, whose first bytes count. Throws InvalidArgument if it cannot hold so many.
Buffer hostBuffer(Gpu& gpu, VkBuffer buffer, uint64_t byteSize);

/// Sets the environment for CPU drivers as Gpu's constructor does for a device of its own, before the first instance of
/// the process. An empty folder: the user's.
void prepareDrivers(const std::filesystem::path& cacheFolder, bool draws);

/// The device of the instance that DeviceOptions::select means. Throws Error that names the devices if none or more
/// than one fits.
VkPhysicalDevice selectPhysicalDevice(const HostDevice& host, std::string_view select);

/// What of the features the engine would use on the physical device; queue, device and `enabled` do not count. Throws
/// InvalidArgument if it is none of the instance or older than Vulkan 1.2.
HostFeatures usefulFeatures(const HostDevice& host);

/// The names of the extensions that those features belong to, which last as long as the program.
std::vector<const char*> extensionsOf(const HostFeatures& features);

}  // namespace xrds
