#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace xrds {

/// The written version of a kernel: `plain` is the readable one and runs anywhere, `lane` keeps one token a lane for
/// CPU devices, `tile` shares memory for GPUs, `matrix` uses matrix units, and `fused` besides makes whole layers in
/// one kernel. An operator without it falls back: `fused` to `matrix`, `matrix` to `tile`, all to `plain`.
enum class KernelFamily : uint8_t { plain, lane, tile, matrix, fused };

/// Whether the family's kernels use matrix units.
constexpr bool usesMatrixUnits(KernelFamily family) {
  return family == KernelFamily::matrix || family == KernelFamily::fused;
}

/// "plain", "lane", "tile", "matrix" or "fused".
const char* nameOf(KernelFamily family);

/// The names of all families, in their order.
std::span<const char* const> kernelFamilyNames();

/// The family of that name. Throws Error that lists the names if there is none.
KernelFamily kernelFamilyOf(std::string_view name);

/// How kernels reach a device's matrix units: through one of two extensions, or, for tests, by plain arithmetic on the
/// same fragments. All multiply matrices of 16-bit floats and add up in 32 bits.
enum class MatrixUnits : uint8_t { none, software, nv, khr };

/// "none", "software", "nv" or "khr".
const char* nameOf(MatrixUnits units);

/// The products that matrix units take: rows x depth by depth x columns, 8 or 16 each.
struct MatrixSize {
  uint32_t rows = 16, columns = 16, depth = 16;
  bool halfSums = true;  // the sums may be halves, too, so that fp32 ones are converted in registers
};

/// How the kernel of a family shares out its work, where that may be chosen. What is 0, or does not fit an operator, is
/// left to the operator's own rule.
struct KernelShape {
  uint32_t outputs = 0;   // channels of a lane, fragments of them of a workgroup, or pixels
  uint32_t rows = 0;      // rows of pixels, tokens or queries of an invocation; or the order of its outputs
  uint32_t subgroup = 0;  // invocations of a subgroup, one of subgroupSizes()
  auto operator<=>(const KernelShape&) const = default;
};

/// Which kernel makes an operator.
struct KernelChoice {
  KernelFamily family = KernelFamily::plain;
  KernelShape shape{};
  auto operator<=>(const KernelChoice&) const = default;
};

/// How a CPU device hands the value of one lane to all in few instructions.
enum class LaneCode : uint8_t {
  shuffles,    // by a shuffle with a constant lane
  broadcasts,  // by a broadcast: its shuffles of 64 bits are loops, those of 16 lanes go through memory
  scalars      // by a broadcast: what is equal in all lanes is a scalar to the compiler
};

/// The properties of a device that decide how work is dispatched: plain numbers, testable without a device.
struct DeviceTraits {
  KernelFamily family = KernelFamily::plain;
  KernelShape shape{};                          // asked of its kernels
  MatrixUnits matrixUnits = MatrixUnits::none;  // of the families `matrix` and `fused`
  MatrixSize matrixSize;                        // of their products
  uint32_t subgroupSize = 8;
  uint32_t leastSubgroup = 0, mostSubgroup = 0;  // sizes that a pipeline may ask for; 0: it has no choice
  uint32_t maxGroupSubgroups = 0;                // of a workgroup whose pipeline asks for a size
  uint64_t maxStorageBufferRange = uint64_t{128} << 20;
  uint64_t maxTexelBufferElements = uint64_t{1} << 27;
  uint64_t maxAllocationBytes = uint64_t{1} << 31;
  uint64_t memoryBytes = 0;  // of a GPU, for which frames are cut into large pieces; 0: a CPU device
  uint64_t secondCacheBytes = uint64_t{512} << 10;  // of a core of a CPU
  uint32_t registers = 256;                         // of 32 bits, of an invocation in the smallest subgroups
  uint32_t maxSharedBytes = 32768;
  uint32_t maxGroupInvocations = 1024;
  bool shaderInt64 = false;  // also in subgroup operations
  /// Of a CPU device (engine/drivers/llvmpipe.h). Kernels read it as the constant kLaneCodeConstant, beside those of
  /// their dispatch.
  LaneCode laneCode = LaneCode::shuffles;
  bool bufferAddresses = false;  // of a CPU device: kernels may read buffers by address
};

/// The sizes of subgroups, beside the device's own, that a pipeline of any workgroup may ask for.
std::vector<uint32_t> subgroupSizes(const DeviceTraits& device);

}  // namespace xrds
