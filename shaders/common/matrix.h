// What the kernels for matrix units and their launches agree on.
#ifndef XRDS_SHADERS_COMMON_MATRIX_H
#define XRDS_SHADERS_COMMON_MATRIX_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
const uint kMatrixRows = 8;            // of fragments of a workgroup: tokens or pixels, in sixteens
const uint kLinearMatrixTexels = 4;    // of eight inputs, of a step of `linear`
const uint kConv3x3MatrixTexels = 2;   // and of `conv3x3`
const uint kConv3x3MatrixStride = 18;  // pixels of a row of a workgroup, with the border
XRDS_SHARED_END

#ifdef __cplusplus
#include <algorithm>
#include <bit>

namespace xrds {

/// Whether fragments are multiplied by plain arithmetic.
inline bool inSoftware(const DeviceTraits& device) {
  return device.matrixUnits == MatrixUnits::none || device.matrixUnits == MatrixUnits::software;
}

/// Invocations that multiply fragments together: a subgroup, or those in its place where there are no matrix units.
inline uint32_t matrixLanes(const DeviceTraits& device) {
  constexpr uint32_t kSoftwareSubgroup = 32;
  return inSoftware(device) ? kSoftwareSubgroup : device.subgroupSize;
}

/// The kernel counts on the size of its subgroups, where they are real.
inline void countSubgroups(Dispatch& launch, const DeviceTraits& device) {
  launch.fullSubgroups = !inSoftware(device);
  if (launch.fullSubgroups) launch.subgroupSize = device.subgroupSize;
}

/// How a workgroup shares its 8 rows of `outputs` fragments among its subgroups.
struct MatrixShape {
  uint32_t subgroups = 0;          // 0: the device, the types or the channels are not for the matrix kernel
  uint32_t outputs = 0;            // columns of fragments of the workgroup
  uint32_t rows = 0, columns = 0;  // of fragments of a subgroup
  uint32_t invocations = 0;        // of the workgroup
};

/// The specialization of its kernel.
inline std::vector<uint32_t> matrixConstants(const MatrixShape& shape, MatrixSize size, uint32_t activation,
                                             uint32_t hasResidual) {
  return {shape.subgroups, shape.outputs, shape.rows,   shape.columns, activation,
          hasResidual,     size.rows,     size.columns, size.depth,    shape.invocations};
}

/// What a stage of a kernel has in shared memory, in texels of 16 bytes: all of the workgroup's rows, and of each 16 of
/// its outputs.
struct MatrixStage {
  uint32_t leftTexels = 0, rightTexels = 0;
  uint32_t mostOutputs = 4;  // columns of fragments of a workgroup
};

/// Whether the registers of a subgroup, of any size, hold the sums of two fragments and what is read for them, but not
/// of eight.
inline bool hasFewRegisters(const DeviceTraits& device) {
  constexpr uint32_t kOfEightFragments = 16384;  // bytes
  const uint32_t least = device.leastSubgroup > 0 ? device.leastSubgroup : device.subgroupSize;
  return !inSoftware(device) && device.registers * 4 * least < kOfEightFragments;
}

/// For inputs and weights of halves alone: what is stored in fp32 stays exact.
inline MatrixShape matrixShape(const DeviceTraits& device, MatrixStage stage, DataType inputType, DataType weightType,
                               uint32_t inputChannels, uint32_t outputChannels) {
  constexpr uint32_t kLeastChannels = 16, kTexelBytes = 16, kSumTexels = 64;
  constexpr uint32_t kMostInvocations = 256, kMostSubgroups = 16;  // of a workgroup
  if (!usesMatrixUnits(device.family) || device.matrixUnits == MatrixUnits::none || inputType != DataType::f16 ||
      weightType != DataType::f16 || inputChannels < kLeastChannels || outputChannels < kLeastChannels ||
      device.maxGroupInvocations < kMostInvocations)
    return {};
  const uint32_t lanes = matrixLanes(device);
  MatrixShape shape{.subgroups = std::min(kMostInvocations / lanes, kMostSubgroups), .outputs = stage.mostOutputs};
  if (device.shape.outputs > 0) shape.outputs = std::min(shape.outputs, std::bit_floor(device.shape.outputs));
  const uint32_t fragments = ceilDivide(outputChannels, 16);
  while (3 * (ceilDivide(fragments, shape.outputs) * shape.outputs - fragments) > fragments) shape.outputs /= 2;
  const uint32_t staged = stage.leftTexels + shape.outputs * stage.rightTexels;
  if (std::max(staged, shape.subgroups * kSumTexels) * kTexelBytes > device.maxSharedBytes) return {};
  for (; shape.subgroups > 0; shape.subgroups /= 2) {
    shape.invocations = shape.subgroups * lanes;
    for (shape.rows = 2; shape.rows > 0; --shape.rows) {
      const uint32_t rowGroups = shader::kMatrixRows / shape.rows, columnGroups = shape.subgroups / rowGroups;
      if (shape.subgroups % rowGroups != 0 || columnGroups == 0 || shape.outputs % columnGroups != 0) continue;
      shape.columns = shape.outputs / columnGroups;
      return shape;
    }
  }
  return {};
}

}  // namespace xrds
#endif
#endif
