#pragma once

#include "engine/device.h"

namespace xrds {

/// The written version of the kernels that suits a device: the one place that decides it.
KernelFamily suitableFamily(const DeviceDescription& device);

/// The family of that name, or of $XRDS_KERNEL_FAMILY if it is empty, or the one that suits the device if both are.
/// Throws Error if there is none of that name, or if the device cannot run it.
KernelFamily chosenFamily(const DeviceDescription& device, const std::string& asked);

}  // namespace xrds
