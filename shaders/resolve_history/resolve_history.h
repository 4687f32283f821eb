#ifndef XRDS_SHADERS_RESOLVE_HISTORY_H
#define XRDS_SHADERS_RESOLVE_HISTORY_H
#include "shaders/common/history.h"

XRDS_SHARED_BEGIN
struct ResolveHistoryParams {
  Image sums, guides, target;
  TargetRows rows;
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The frame that MergeHistory's sums are of: (x (a + 0.02), sum w), (a, z), (normal, 0), each the mean, where a >= 0.
/// With `guides` the radiance alone, by their albedo.
struct ResolveHistory {
  TensorView sums;    // [H, W, 12]
  TensorView guides;  // [H, W, >= 4] the albedo in its first three channels; absent: that of the sums
  TensorView output;  // [H, W, 12], of `guides` [H, W, 4]
  RowRange rows{};
};

/// [H, W, 12], with guides [H, W, 4]. Throws std::logic_error if an input is of another size.
TensorShape outputShape(const ResolveHistory& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const ResolveHistory& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const ResolveHistory& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const ResolveHistory& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const ResolveHistory& op);

/// Stored in fp32 always.
void propagate(const ResolveHistory& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<ResolveHistory>& examples);

}  // namespace xrds
#endif
#endif
