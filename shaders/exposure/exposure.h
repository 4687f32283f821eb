#ifndef XRDS_SHADERS_EXPOSURE_H
#define XRDS_SHADERS_EXPOSURE_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
struct ExposureParams {
  Slice source;
  uint pixelCount;
  uint target;  // vec4 index of the result
};

const uint kExposureGroup = 256;
const float kExposureKey = 0.18f;
const float kExposureMinLuminance = 1e-8f;
const float kExposureMin = 1e-37f;  // of which the reciprocal is a float too
XRDS_SHARED_END

#ifdef __cplusplus
namespace xrds {

/// The automatic exposure of an image: 0.18 over the geometric mean of its Rec. 709 luminances L, taken over the pixels
/// with finite L > 1e-8, at least 1e-37; 1 if there are none.
struct Exposure {
  TensorView colour;  // [h, w, 4] linear radiance
  TensorView output;  // [1, 1, 4] f32: e, 1 / e, the number of pixels that count, 0
};

/// [1, 1, 4].
TensorShape outputShape(const Exposure& op);

/// One workgroup, so that the sum has one order. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const Exposure& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const Exposure& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const Exposure& op, HostMemory& memory);

}  // namespace xrds
#endif
#endif
