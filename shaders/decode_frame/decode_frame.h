#ifndef XRDS_SHADERS_DECODE_FRAME_H
#define XRDS_SHADERS_DECODE_FRAME_H
#include "shaders/common/frame_curve.h"

XRDS_SHARED_BEGIN
struct DecodeFrameParams {
  Image source, target;
  TargetRows rows;
  int exposure;  // vec4 index
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The image that a denoiser's network has made: EncodeFrame's curve inverted, radiance over the exposure.
struct DecodeFrame {
  TensorView input;       // [>= h, >= w, 4]
  TensorView exposure{};  // [1, 1, 4] f32 (e, 1 / e, ..): read for FrameCurve::hdr
  TensorView output;  // [h, w, 4] f32; the fourth channel is 1 where the input was not finite and counts as 0, else 0
  FrameCurve curve = FrameCurve::hdr;
  RowRange rows{};  // of the output
};

/// The shape of the output. Throws std::logic_error if the input does not hold it.
TensorShape outputShape(const DecodeFrame& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const DecodeFrame& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const DecodeFrame& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const DecodeFrame& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const DecodeFrame& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const DecodeFrame& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<DecodeFrame>& examples);

}  // namespace xrds
#endif
#endif
