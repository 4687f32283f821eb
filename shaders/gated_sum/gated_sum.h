#ifndef XRDS_SHADERS_GATED_SUM_H
#define XRDS_SHADERS_GATED_SUM_H
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
struct GatedSumParams {
  Image source, addend, target;
  TargetRows rows;
  uint gateOffset;  // texel
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// y = x * gate + addend, one gate a channel (channel attention's last step, RCAN, Zhang et al. 2018, equation 9);
/// without a gate y = x + addend.
struct GatedSum {
  TensorView input, output;  // [h, w, c]
  TensorView gate{};         // [1, 1, c] f32, of ChannelGate; optional
  TensorView addend;         // as the output, but another value: lanes make a last column several times
  RowRange rows{};
};

/// [h, w, c]. Throws std::logic_error if the gate does not fit the input.
TensorShape outputShape(const GatedSum& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const GatedSum& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const GatedSum& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const GatedSum& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const GatedSum& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const GatedSum& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<GatedSum>& examples);

}  // namespace xrds
#endif
#endif
