#ifndef XRDS_SHADERS_ENCODE_FRAME_H
#define XRDS_SHADERS_ENCODE_FRAME_H
#include "shaders/common/frame_curve.h"

XRDS_SHARED_BEGIN
struct EncodeFrameParams {
  Image source, guides, target;
  TargetRows rows;
  int exposure;  // vec4 index
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// What a denoiser's network sees: the image by its curve, radiance times the exposure first; behind it the albedo from
/// 0 to 1 and the normal from -1 to 1 brought to 0 to 1. Zero outside of the image. NaN counts as 0.
struct EncodeFrame {
  TensorView input;       // [h, w, 4] f32
  TensorView guides{};    // [h, w, 4] of an albedo or [h, w, 8] of albedo and normal, f32; absent: the image alone
  TensorView exposure{};  // [1, 1, 4] f32 (e, 1 / e, ..): read for FrameCurve::hdr
  TensorView output;      // [>= h, >= w, 4, 8 or 12], the channels behind the last image 0
  FrameCurve curve = FrameCurve::hdr;
  RowRange rows{};  // of the output
};

/// The shape of the output. Throws std::logic_error if the images do not fit each other.
TensorShape outputShape(const EncodeFrame& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const EncodeFrame& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const EncodeFrame& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const EncodeFrame& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const EncodeFrame& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const EncodeFrame& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<EncodeFrame>& examples);

}  // namespace xrds
#endif
#endif
