#ifndef XRDS_SHADERS_BOX_SUM_H
#define XRDS_SHADERS_BOX_SUM_H
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
struct BoxSumParams {
  Image source, target;
  TargetRows rows;
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// Sum over scale x scale pixels: brings the auxiliary images to the colour's resolution.
struct BoxSum {
  TensorView input, output;  // [s h, s w, c], [h, w, c]
  uint32_t scale = 1;        // s: 1, 2, 4, 8 or 16
  RowRange rows{};
};

/// [h, w, c]. Throws std::logic_error if the input is no multiple of the scale.
TensorShape outputShape(const BoxSum& op);

/// The kernel launch for the rows, or their copy if the mean is of one pixel. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const BoxSum& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const BoxSum& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const BoxSum& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const BoxSum& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const BoxSum& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<BoxSum>& examples);

}  // namespace xrds
#endif
#endif
