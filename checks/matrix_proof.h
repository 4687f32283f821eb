#pragma once

#include "engine/device.h"

namespace xrds {

/// Compares the matrix kernels of a device that runs them with their double-precision reference, on a small linear map,
/// a small convolution and, where layers are fused, a small Swin layer. Where they are wrong or fail, the device runs
/// the tile kernels from then on, and layers operator by operator where only the fused one is wrong or does not fit.
/// Returns whether they are right, or not in use.
bool proveMatrixKernels(Gpu& gpu);

/// The same. Throws Error if the device then does not run the kernel family of the name `asked`, unless that is empty.
void proveAskedKernels(Gpu& gpu, const std::string& asked);

}  // namespace xrds
