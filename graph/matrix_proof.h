#pragma once

#include "engine/device.h"

namespace xrds {

/// Compares the matrix kernels of a device that runs them with their double-precision reference, on a small linear map
/// and a small convolution. Where they are wrong or fail, the device runs the tile kernels from then on. Returns
/// whether they are right, or not in use.
bool proveMatrixKernels(Gpu& gpu);

}  // namespace xrds
