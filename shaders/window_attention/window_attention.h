#ifndef XRDS_SHADERS_WINDOW_ATTENTION_H
#define XRDS_SHADERS_WINDOW_ATTENTION_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
struct WindowAttentionParams {
  Slice queries, keys, values, target;
  uint width, height;     // of the image, in pixels
  uint rowBegin, rowEnd;  // image rows that are stored
  uint shift;             // position (y, x) of the shifted image is pixel (y + shift, x + shift), cyclic
  uint firstWindowRow;    // of this dispatch, in the shifted image; window rows are cyclic too
  uint headCount;
  uint storeOrigin;  // vec4 index at which the target binding starts
};
const uint kAttentionTileKeys = 8;      // whose scores the tile kernel takes together
const uint kAttentionMatrixWindow = 8;  // of the matrix kernel, as are those below: texels of its pool's rows
const uint kAttentionScoreStride = 17, kAttentionValueStride = 9;
XRDS_SHARED_END
// Of the pool of the matrix kernel, by the channels d of a head: texels of a row of q or k, and where v begins.
#define ATTENTION_HEAD_STRIDE(d) ((d) / 8 + 1)
#define ATTENTION_VALUES_AT(d) (64 * (2 * ATTENTION_HEAD_STRIDE(d) > 17 ? 2 * ATTENTION_HEAD_STRIDE(d) : 17))

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// Softmax attention inside each window x window square of tokens, for each head: softmax(q k^T / sqrt(d) + bias) v
/// with d = headChannels ("WMSA" and, with keys and values of another image, "WMCA", without their linear maps).
/// A shift moves the windows cyclically; tokens that only the wrap-around brought together do not see each other.
struct WindowAttention {
  TensorView queries, keys, values, output;  // [h, w, c], often slices of one tensor; h and w multiples of window
  std::span<const float> biasTable;  // [(2 window - 1)^2][heads], row (yq - yk + window - 1)(2 window - 1) + ...
  uint32_t window = 8, headChannels = 32, shift = 0;  // heads = c / headChannels; shift is 0 or window / 2
  RowRange rows{};                                    // cheapest when it begins at shift + a multiple of window
};

/// The shape of the queries. Throws std::logic_error on sizes that do not fit each other.
TensorShape outputShape(const WindowAttention& op);

/// The kernel launch over all windows that meet the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const WindowAttention& op, const DeviceTraits& device);

/// Shapes of the device's family that are worth a try beside the rule's own: queries of a lane.
std::vector<KernelShape> shapesToTry(const WindowAttention& op, const DeviceTraits& device);

/// The bias table as the kernel of that device reads it (see the kernels' heads).
std::vector<float> packedWeights(const WindowAttention& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const WindowAttention& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const WindowAttention& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const WindowAttention& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<WindowAttention>& examples);

}  // namespace xrds
#endif
#endif
