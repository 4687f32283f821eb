#ifndef XRDS_SHADERS_DILATED_MEAN_H
#define XRDS_SHADERS_DILATED_MEAN_H
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
struct DilatedMeanParams {
  Image source, target;
  TargetRows rows;
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// Mean of the 3 x 3 pixels around each, `step` apart: of images that are such means with a third of the step, the mean
/// of 3 step x 3 step pixels. Neighbours outside of the image take the values of its border.
struct DilatedMean {
  TensorView input;   // [>= h, >= w, c]; only its first h x w pixels are read
  TensorView output;  // [h, w, c]
  uint32_t step = 1;
  RowRange rows{};
};

/// The shape of the output, which states h and w. Throws std::logic_error if the input does not hold it.
TensorShape outputShape(const DilatedMean& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const DilatedMean& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const DilatedMean& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const DilatedMean& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const DilatedMean& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const DilatedMean& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<DilatedMean>& examples);

}  // namespace xrds
#endif
#endif
