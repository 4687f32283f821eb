#ifndef XRDS_SHADERS_UPSAMPLE_NEAREST_H
#define XRDS_SHADERS_UPSAMPLE_NEAREST_H
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
struct UpsampleNearestParams {
  Image source, target;
  TargetRows rows;
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// Twice the resolution, each pixel as 2 x 2 of its value: PyTorch's interpolate(x, scale_factor=2, mode="nearest").
struct UpsampleNearest {
  TensorView input;   // [h, w, c]
  TensorView output;  // [2h, 2w, c]
  RowRange rows{};    // of the output
};

/// [2h, 2w, c].
TensorShape outputShape(const UpsampleNearest& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const UpsampleNearest& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const UpsampleNearest& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const UpsampleNearest& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const UpsampleNearest& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const UpsampleNearest& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<UpsampleNearest>& examples);

}  // namespace xrds
#endif
#endif
