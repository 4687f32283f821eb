#ifndef XRDS_SHADERS_FOLD_H
#define XRDS_SHADERS_FOLD_H
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
struct FoldParams {
  Image source, target;
  TargetRows rows;
};
const int kFoldSide = 4;  // of a patch
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The sum of overlapping patches: pixel (y, x) of the input holds, for each output channel n, the 4 x 4 pixels that it
/// adds to the output from (2 y - 1, 2 x - 1) on; what falls outside is dropped. PyTorch's fold() with kernel_size 4,
/// stride 2 and padding 1, whose order of channels it has.
struct Fold {
  TensorView input;   // [h, w, 16 N], channel 16 n + 4 i + j is row i, column j of the patch
  TensorView output;  // [2h, 2w, N rounded up to a multiple of four, with zeros]
  RowRange rows{};    // of the output
};

/// [2h, 2w, N rounded up to a multiple of four]. Throws std::logic_error if the input's channels are no patches.
TensorShape outputShape(const Fold& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const Fold& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const Fold& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const Fold& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const Fold& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const Fold& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<Fold>& examples);

}  // namespace xrds
#endif
#endif
