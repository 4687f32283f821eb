#pragma once

#include <volk.h>

#include "engine/device.h"

namespace xrds {

/// Registers of 32 bits that an invocation may have, by VkPhysicalDeviceProperties: 128 on GPUs of Intel (in its
/// smallest subgroups), Apple and Qualcomm, 64 on those of ARM and Broadcom, 256 on others. Vulkan does not tell: these
/// are Mesa's figures. More than enough on CPU devices, which keep in the cache what has no room.
uint32_t registersOf(uint32_t vendorId, DeviceKind kind);

/// The traits of a device that runs the family: its limits, and what its description says of its matrix units. A
/// pipeline may choose its subgroups only where the device is opened for that.
DeviceTraits traitsOf(VkPhysicalDevice device, const DeviceDescription& description, KernelFamily family,
                      bool choosesSubgroups);

}  // namespace xrds
