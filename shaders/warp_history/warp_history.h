#ifndef XRDS_SHADERS_WARP_HISTORY_H
#define XRDS_SHADERS_WARP_HISTORY_H
#include "shaders/common/history.h"

XRDS_SHARED_BEGIN
struct WarpHistoryParams {
  Image positions, history, present, target;
  TargetRows rows;
  int exposure;  // texel of (e, 1 / e, ...)
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// Another frame h of a sequence brought to where the present one p shows the same, and how it differs. With the light
/// x = c / (a + 0.02) of radiance c and albedo a >= 0, at the position q of the pixel, all interpolated by
/// Catmull and Rom's cubic convolution and clamped to the four nearest pixels, which keeps edges:
/// (x_h, n_h inside), (t(x_h) - t(x_p), (z_h - z_p) / max(z_h, z_p)), (a_h - a_p, 0), (normal_h - normal_p, 0) with the
/// count n, the nearness z and t(x) = e x / (1 + e x).
struct WarpHistory {
  TensorView positions;  // [H, W, 4] of FollowMotion, or their box means over `scale`, in pixels of the finer image
  TensorView history;    // [H, W, 12], a frame as shaders/common/history.h has it
  TensorView present;    // [H, W, 12]
  TensorView exposure;   // [1, 1, 4] e, 1 / e
  TensorView output;     // [H, W, 16]
  uint32_t scale = 1;
  RowRange rows{};
};

/// [H, W, 16]. Throws std::logic_error if an input is of another size.
TensorShape outputShape(const WarpHistory& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const WarpHistory& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const WarpHistory& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const WarpHistory& op, HostMemory& memory);

/// What the rest of the house asks of it. It may read the history anywhere.
OperatorFacts facts(const WarpHistory& op);

/// Stored in fp32 always.
void propagate(const WarpHistory& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<WarpHistory>& examples);

}  // namespace xrds
#endif
#endif
