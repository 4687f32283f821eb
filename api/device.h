#pragma once

#include "engine/device.h"
#include "xrds/device.h"

namespace xrds {

/// What Device of the public API does, on the engine's device.
std::vector<Device::Description> describeDevices();
Device::Description descriptionOf(const Gpu& gpu);
Gpu openGpu(const Device::Options& options);
/// Shares a program's device, which must outlive what is returned. Of the options `select` must be empty.
Gpu openGpu(const Device::Options& options, const HostDevice& host);

}  // namespace xrds
