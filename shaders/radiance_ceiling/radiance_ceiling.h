#ifndef XRDS_SHADERS_RADIANCE_CEILING_H
#define XRDS_SHADERS_RADIANCE_CEILING_H
#include "shaders/common/image.h"
#include "shaders/common/transfer.h"

XRDS_SHARED_BEGIN
struct RadianceCeilingParams {
  Image source, target;
  TargetRows rows;
};

const int kCeilingReach = 2;        // low-resolution pixels to each side: as far as the base images read
const float kCeilingFactor = 4.0f;  // g
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The most that the network may make of its surroundings: T(g T^-1(m)), with m the largest of the 5 x 5 values of x
/// around a low-resolution pixel, in each channel, and g = 4. Where they are black, it is zero.
struct RadianceCeiling {
  TensorView input;   // [>= h, >= w, 4] x; only its first h x w pixels are read
  TensorView output;  // [h, w, 4], the fourth channel zero
  Transfer transfer = Transfer::none;
  RowRange rows{};
};

/// The shape of the output, which states h and w. Throws std::logic_error if the input does not hold it.
TensorShape outputShape(const RadianceCeiling& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const RadianceCeiling& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const RadianceCeiling& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const RadianceCeiling& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const RadianceCeiling& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const RadianceCeiling& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<RadianceCeiling>& examples);

}  // namespace xrds
#endif
#endif
