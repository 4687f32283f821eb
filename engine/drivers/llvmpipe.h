#pragma once

#include <cstdint>
#include <string_view>

#include "engine/device_traits.h"

namespace xrds {

/// What is known of Mesa's Vulkan driver for CPUs. Tried: Mesa 22.3, 25.0, 26.1 and 26.2.
struct LlvmpipeTraits {
  /// Shuffles before Mesa 23.2, whose broadcasts search for the first lane in a loop; scalars from Mesa 25.1 on,
  /// broadcasts between. With scalars fma() is one instruction, at the latest in Mesa 26.2; in 26.1 it is two.
  LaneCode laneCode = LaneCode::shuffles;
  /// It takes long to prepare programs with many loads of shared memory (engine/pipelines/shared_loads.h): all versions
  /// tried.
  bool comparesSharedLoads = false;
};

/// Whether its products of matrices work: Mesa 26.2 multiplies 8 x 8 of them in subgroups of 8 lanes, and crashes on
/// them in wider ones. True of any other driver.
bool llvmpipeMultiplies(std::string_view driver, uint32_t subgroupSize);

/// By DeviceDescription::driver, "llvmpipe Mesa 26.2.6-1 (LLVM 22.1.8)"; the defaults for any other driver.
LlvmpipeTraits llvmpipeTraits(std::string_view driver);

}  // namespace xrds
