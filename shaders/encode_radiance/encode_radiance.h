#ifndef XRDS_SHADERS_ENCODE_RADIANCE_H
#define XRDS_SHADERS_ENCODE_RADIANCE_H
#include "shaders/common/image.h"
#include "shaders/common/transfer.h"

XRDS_SHARED_BEGIN
struct EncodeRadianceParams {
  Image colour, auxMean, target;
  TargetRows rows;
  int exposure;  // texel of (e, 1 / e, ...)
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The colour as the network sees it: x = T(e I / (b + 0.02)) with b the mean albedo, or T(e I) where the model does
/// not demodulate, padded on the right and at the bottom by edge replication of x, or by its reflection, which does not
/// repeat the edge (back and forth where the image is smaller than the padding).
struct EncodeRadiance {
  TensorView colour;      // [h, w, 4] linear radiance I
  TensorView exposure;    // [1, 1, 4] e, 1 / e
  TensorView auxMean{};   // [hp, wp, c], needed to demodulate
  TensorView output;      // [hp, wp, 4], the fourth channel zero
  int albedoOffset = -1;  // first channel of b in auxMean; -1: no demodulation
  Transfer transfer = Transfer::none;
  bool reflects = false;  // how it is padded
  RowRange rows{};
};

/// The shape of the output, whose size states the padding. Throws std::logic_error if an input does not fit it.
TensorShape outputShape(const EncodeRadiance& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const EncodeRadiance& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const EncodeRadiance& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const EncodeRadiance& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const EncodeRadiance& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const EncodeRadiance& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<EncodeRadiance>& examples);

}  // namespace xrds
#endif
#endif
