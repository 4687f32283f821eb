#pragma once

#include <volk.h>

#include "engine/device.h"

namespace xrds {

/// Registers of 32 bits that an invocation may have, by VkPhysicalDeviceProperties: 128 on GPUs of Intel (in its
/// smallest subgroups), Apple and Qualcomm, 64 on those of ARM and Broadcom, 256 on others. Vulkan does not tell: these
/// are Mesa's figures. More than enough on CPU devices, which keep in the cache what has no room.
uint32_t registersOf(uint32_t vendorId, DeviceKind kind);

/// Whether a GPU with so many registers an invocation runs the kernels of `half`. With 128 those of Intel spill, those
/// of Qualcomm have half the subgroups beside each other, and Apple's gain nothing.
bool holdsHalves(uint32_t registers);

/// Whether GPUs of that maker, as far as is known, take two halves in the place of a float in an instruction: AMD's.
/// NVIDIA's do from Turing on, where most have matrix units, and are 64 times slower before: tuning tells.
bool pairsHalves(uint32_t vendorId);

/// The traits of a device that runs the family: its limits, and what its description says of its matrix units. A
/// pipeline may choose its subgroups only where the device is opened for that.
DeviceTraits traitsOf(VkPhysicalDevice device, const DeviceDescription& description, KernelFamily family,
                      bool choosesSubgroups);

}  // namespace xrds
