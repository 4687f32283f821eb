#ifndef XRDS_SHADERS_ROW_MEAN_H
#define XRDS_SHADERS_ROW_MEAN_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
struct RowMeanParams {
  Slice source, target;
  uint width;  // of the input
  uint rowBegin, rowEnd;
  uint storeOrigin;  // vec4 index at which the target binding starts
};
const uint kRowMeanGroup = 64;  // invocations
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The mean of each channel over each row: the first half of an image's global mean, of which ChannelGate takes the
/// second. Rows are summed apart so that many invocations share the work and the order of the sum never changes.
struct RowMean {
  TensorView input;   // [h, w, c]
  TensorView output;  // [h, 1, c] f32
  RowRange rows{};
};

/// [h, 1, c].
TensorShape outputShape(const RowMean& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const RowMean& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const RowMean& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const RowMean& op, HostMemory& memory);

/// What the rest of the house asks of it: a result reads the whole row.
OperatorFacts facts(const RowMean& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const RowMean& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<RowMean>& examples);

}  // namespace xrds
#endif
#endif
