// What the kernels for matrix units and their launches agree on.
#ifndef XRDS_SHADERS_COMMON_MATRIX_H
#define XRDS_SHADERS_COMMON_MATRIX_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
const uint kMatrixInvocations = 256;   // of a workgroup
const uint kMatrixRows = 8;            // of fragments of a workgroup: tokens or pixels, in sixteens
const uint kLinearMatrixTexels = 4;    // of eight inputs, of a step of `linear`
const uint kConv3x3MatrixTexels = 2;   // and of `conv3x3`
const uint kConv3x3MatrixStride = 18;  // pixels of a row of a workgroup, with the border
XRDS_SHARED_END

#ifdef __cplusplus
namespace xrds {

/// How a workgroup shares its 8 rows of `outputs` fragments among its subgroups.
struct MatrixShape {
  uint32_t subgroups = 0;          // 0: the device, the types or the channels are not for the matrix kernel
  uint32_t outputs = 0;            // columns of fragments of the workgroup
  uint32_t rows = 0, columns = 0;  // of fragments of a subgroup
};

/// For inputs and weights of halves alone: what is stored in fp32 stays exact.
inline MatrixShape matrixShape(const DeviceTraits& device, DataType inputType, DataType weightType,
                               uint32_t inputChannels, uint32_t outputChannels) {
  constexpr uint32_t kSoftwareSubgroup = 32, kLeastChannels = 16, kSharedBytes = 24576;  // of the larger kernel
  if (device.family != KernelFamily::matrix || device.matrixUnits == MatrixUnits::none || inputType != DataType::f16 ||
      weightType != DataType::f16 || inputChannels < kLeastChannels || outputChannels < kLeastChannels ||
      device.maxGroupInvocations < shader::kMatrixInvocations || device.maxSharedBytes < kSharedBytes)
    return {};
  const uint32_t lanes = device.matrixUnits == MatrixUnits::software ? kSoftwareSubgroup : device.subgroupSize;
  MatrixShape shape{.subgroups = shader::kMatrixInvocations / lanes, .outputs = 4};
  const uint32_t fragments = ceilDivide(outputChannels, 16);
  while (3 * (ceilDivide(fragments, shape.outputs) * shape.outputs - fragments) > fragments) shape.outputs /= 2;
  for (shape.rows = 2; shape.rows > 0; --shape.rows) {
    const uint32_t rowGroups = shader::kMatrixRows / shape.rows, columnGroups = shape.subgroups / rowGroups;
    if (shape.subgroups % rowGroups != 0 || columnGroups == 0 || shape.outputs % columnGroups != 0) continue;
    shape.columns = shape.outputs / columnGroups;
    return shape;
  }
  return {};
}

}  // namespace xrds
#endif
#endif
