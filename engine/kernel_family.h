#pragma once

#include "engine/device.h"

namespace xrds {

/// The written version of the kernels that suits a device: the one place that decides it.
KernelFamily suitableFamily(const DeviceDescription& device);

/// The family of that name, or of $XRDS_KERNEL_FAMILY if it is empty, or the one that suits the device if both are.
/// Throws Error if there is none of that name, or if the device cannot run it.
KernelFamily chosenFamily(const DeviceDescription& device, const std::string& asked);

/// What a device would run if it were opened without asking for a family: what $XRDS_KERNEL_FAMILY names, or where the
/// device cannot run that, what suits it. Throws Error if the variable names no family.
KernelFamily likelyFamily(const DeviceDescription& device);

/// A device of which no more is known than its kernel family: the usual limits of those that run it.
DeviceTraits usualTraits(KernelFamily family);

}  // namespace xrds
