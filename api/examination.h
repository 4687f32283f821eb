#pragma once

#include "engine/device.h"
#include "network/network.h"
#include "xrds/examination.h"

namespace xrds {

/// Examination::capabilities, ::kernels and ::knownFrame of an open device.
DeviceCapabilities capabilitiesOf(const Gpu& gpu);
std::vector<KernelExamination> examineKernels(Gpu& gpu, Precision precision, uint32_t runs);
FrameExamination examineKnownFrame(Gpu& gpu, Precision precision, uint32_t runs);

}  // namespace xrds
