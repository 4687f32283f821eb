#ifndef XRDS_SHADERS_MERGE_HISTORY_H
#define XRDS_SHADERS_MERGE_HISTORY_H
#include "shaders/common/history.h"

XRDS_SHARED_BEGIN
struct MergeHistoryParams {
  Image warped, present, sums, target;
  TargetRows rows;
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// Adds what WarpHistory made of another frame to the weighted sums of a frame. The weight of the pixel's guides is
/// g = n exp(-|a|^2 / 0.2^2 - |normal|^2 / 0.35^2 - z^2 / 0.1^2) of the differences' means over 3 x 3 pixels, n its
/// count. That of its light is g / (1 + r + r^2), r = 6 n b / v; g / (1 + n b / v) would make the mean's expected error
/// least if the light were even around. Where it is not, a pixel's bias is larger. v is the variance of one frame's
/// pixel, from that of the difference t over the (2 r + 1)^2 pixels around, var(t) n k / (n + k) summed over the
/// channels with the present pixel's count k, and b the squared bias, the sum of max(0, mean(t)^2 - l var(t) / (2
/// r + 1)^2), 0 where the means differ as noise does; l = n / k, at least 1 and at most 4: the longer a history, the
/// surer must be what refuses it. The sums are (sum w x, sum w), (sum g a, sum g z) and (sum g normal,
/// sum g).
struct MergeHistory {
  TensorView warped;    // [H, W, 16] of WarpHistory
  TensorView present;   // [H, W, 12], a frame as shaders/common/history.h has it
  TensorView sums;      // [H, W, 12] so far; absent: those of the present frame alone, with the weight of its count
  TensorView output;    // [H, W, 12]
  uint32_t radius = 2;  // r
  RowRange rows{};
};

/// [H, W, 12]. Throws std::logic_error if an input is of another size.
TensorShape outputShape(const MergeHistory& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const MergeHistory& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const MergeHistory& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const MergeHistory& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const MergeHistory& op);

/// Stored in fp32 always.
void propagate(const MergeHistory& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<MergeHistory>& examples);

}  // namespace xrds
#endif
#endif
