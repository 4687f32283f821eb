#pragma once

#include <span>
#include <string_view>

#include "engine/device.h"

namespace xrds {

/// The position in `devices` that the text of DeviceOptions::select means. One or two digits are an index, 32
/// hexadecimal digits (dashes allowed) a UUID, anything else a name or a part of one, whatever its case.
/// Throws Error that names the devices if none or more than one fits.
size_t selectDevice(std::span<const DeviceDescription> devices, std::string_view select);

/// Throws Error if the device's driver is known to make wrong programs of the kernels: MoltenVK before 1.3, which gives
/// arrays the sizes that they have without specialization.
void checkDriver(const DeviceDescription& device);

}  // namespace xrds
