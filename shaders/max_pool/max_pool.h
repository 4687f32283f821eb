#ifndef XRDS_SHADERS_MAX_POOL_H
#define XRDS_SHADERS_MAX_POOL_H
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
struct MaxPoolParams {
  Image source, target;
  TargetRows rows;
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The largest of 2 x 2 pixels, channel by channel: PyTorch's max_pool2d(x, 2).
struct MaxPool {
  TensorView input;   // [2h, 2w, c]
  TensorView output;  // [h, w, c]
  RowRange rows{};    // of the output
};

/// [h, w, c]. Throws std::logic_error if a side of the input is odd.
TensorShape outputShape(const MaxPool& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const MaxPool& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const MaxPool& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const MaxPool& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const MaxPool& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const MaxPool& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<MaxPool>& examples);

}  // namespace xrds
#endif
#endif
