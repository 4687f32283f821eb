#pragma once

#include "engine/device.h"
#include "network/network.h"
#include "xrds/examination.h"

namespace xrds {

/// Examination::kernels and ::knownFrame of an open device.
std::vector<KernelExamination> examineKernels(Gpu& gpu, Precision precision, uint32_t runs);
FrameExamination examineKnownFrame(Gpu& gpu, Precision precision, uint32_t runs);

}  // namespace xrds
