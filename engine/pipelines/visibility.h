#pragma once

#include <vector>

#include "engine/pipelines/spirv.h"

namespace xrds {

/// The SPIR-V module with what invocations of a workgroup show each other made available and visible by barriers alone.
/// glslang asks it of every access to shared memory of a program in Vulkan's memory model, which the kernels for matrix
/// units are in: drivers then wait after each load (RADV: twice as many waits). Other modules stay as they are.
std::vector<uint32_t> visibleAtBarriers(SpirvWords module);

}  // namespace xrds
