#pragma once

#include <vector>

#include "engine/spirv.h"

namespace xrds {

/// The SPIR-V module with its loads of shared memory made volatile. Mesa 22.3 compares each load that is not with all
/// before it, to find those of the same place: kernels that read thousands of weights, each once, take two to three
/// times as long to prepare. llvmpipe makes the same machine code of both.
std::vector<uint32_t> withVolatileSharedLoads(SpirvWords module);

}  // namespace xrds
