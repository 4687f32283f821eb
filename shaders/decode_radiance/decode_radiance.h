#ifndef XRDS_SHADERS_DECODE_RADIANCE_H
#define XRDS_SHADERS_DECODE_RADIANCE_H
#include "shaders/common/image.h"
#include "shaders/common/transfer.h"

XRDS_SHARED_BEGIN
struct DecodeRadianceParams {
  Image network, base, ceiling, aux, colour, target;
  TargetRows rows;
  int exposure;  // texel of (e, 1 / e, ...)
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The result image: T^-1(clamp(base + network, 0, max(min(11, c), base))) (a + 0.02) / e with the albedo a and the
/// ceiling c, cropped to the real image. Without a base T^-1(network) is not clamped; without demodulation there is no
/// factor (a + 0.02). Where the network is not finite its share is left out and the fourth channel tells so; what is
/// too large becomes the largest float. Of a colour d the change alone is taken, and of that a share:
/// y = d + darker min(y' - d, 0) + brighter max(y' - d, 0) with y' as above and d at least 0.
struct DecodeRadiance {
  TensorView network{};   // optional [>= H, >= W, >= 4], of which three channels are read; absent: zero
                          // (a base is then needed)
  TensorView base{};      // optional [>= H, >= W, 4]
  TensorView ceiling{};   // optional [>= ceil(H / s), >= ceil(W / s), 4] of RadianceCeiling; absent: 11
  TensorView aux{};       // [>= H, >= W, c], needed to demodulate
  TensorView colour{};    // optional [>= H, >= W, 4] linear radiance
  TensorView exposure;    // [1, 1, 4] e, 1 / e
  TensorView output;      // [H, W, 4] linear radiance, the fourth channel zero
  int albedoOffset = -1;  // first channel of a in aux; -1: no demodulation
  Transfer transfer = Transfer::none;
  uint32_t scale = 1;              // s: pixels of the output to a side of one of the ceiling
  float darker = 1, brighter = 1;  // from 0 to 1; of a colour
  RowRange rows{};
};

/// The shape of the output, whose size states the crop. Throws std::logic_error if an input does not hold it.
TensorShape outputShape(const DecodeRadiance& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const DecodeRadiance& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const DecodeRadiance& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const DecodeRadiance& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const DecodeRadiance& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const DecodeRadiance& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<DecodeRadiance>& examples);

}  // namespace xrds
#endif
#endif
