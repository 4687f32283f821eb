#ifndef XRDS_SHADERS_CHANNEL_GATE_H
#define XRDS_SHADERS_CHANNEL_GATE_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
struct ChannelGateParams {
  Slice source, target;
  uint height;  // rows of the input
};
const uint kChannelGateGroup = 64;  // invocations
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The gates of channel attention (RCAN, Zhang et al. 2018, equation 8): sigmoid(W_U relu(W_D z + b_D) + b_U), where z
/// is the global mean of each channel, from the means of the rows.
struct ChannelGate {
  TensorView input;                             // [h, 1, c] f32, of RowMean
  TensorView output;                            // [1, 1, c] f32
  std::span<const float> weight{}, bias{};      // W_D [c / r][c], b_D [c / r]
  std::span<const float> upWeight{}, upBias{};  // W_U [c][c / r], b_U [c]
};

/// [1, 1, c]. Throws std::logic_error if the weights do not fit the input.
TensorShape outputShape(const ChannelGate& op);

/// One workgroup. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const ChannelGate& op, const DeviceTraits& device);

/// W_D, b_D, W_U transposed and b_U, with c / r rounded up to a multiple of four.
std::vector<float> packedWeights(const ChannelGate& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const ChannelGate& op, HostMemory& memory);

/// What the rest of the house asks of it: a result reads the whole image.
OperatorFacts facts(const ChannelGate& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const ChannelGate& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<ChannelGate>& examples);

}  // namespace xrds
#endif
#endif
