#ifndef XRDS_SHADERS_LAYER_NORM_H
#define XRDS_SHADERS_LAYER_NORM_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
struct LayerNormParams {
  Slice source, target;
  uint tokenBegin;  // first token of this dispatch
  uint tokenEnd;
  uint storeOrigin;  // vec4 index at which the target binding starts
  float epsilon;
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// Layer normalization over the channels of each token, with an affine map ("LN" in the Swin layers).
struct LayerNorm {
  TensorView input, output;             // [h, w, c]
  std::span<const float> weight, bias;  // [c] each
  float epsilon = 1e-5f;
  RowRange rows{};
};

/// The shape of the input. Throws std::logic_error if weight or bias does not fit it.
TensorShape outputShape(const LayerNorm& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const LayerNorm& op, const DeviceTraits& device);

/// What the kernel reads as its weights: weight, then bias.
std::vector<float> packedWeights(const LayerNorm& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const LayerNorm& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const LayerNorm& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const LayerNorm& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<LayerNorm>& examples);

}  // namespace xrds
#endif
#endif
