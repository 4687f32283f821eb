#pragma once

#include <volk.h>

#include "engine/device.h"

namespace xrds {

/// The traits of a device that runs the family: its limits, and what its description says of its matrix units.
DeviceTraits traitsOf(VkPhysicalDevice device, const DeviceDescription& description, KernelFamily family);

}  // namespace xrds
