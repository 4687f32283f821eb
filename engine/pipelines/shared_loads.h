#pragma once

#include <vector>

#include "engine/pipelines/spirv.h"

namespace xrds {

/// The SPIR-V module with its loads of shared memory made volatile. Mesa compares each load that is not with all before
/// it, to find those of the same place. The lane kernels read thousands of weights, each once: without that they are
/// prepared in a third of the time by Mesa 22.3, the whole U-Net of xrds denoise in 0.7 of it by 25.0 and 26.1. They
/// run as fast.
std::vector<uint32_t> withVolatileSharedLoads(SpirvWords module);

}  // namespace xrds
