#ifndef XRDS_SHADERS_SWIN_LAYER_H
#define XRDS_SHADERS_SWIN_LAYER_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
struct SwinLayerParams {
  Slice source, target;
  uint width, height;     // of the image, in pixels
  uint rowBegin, rowEnd;  // image rows that are stored
  uint shift;             // position (y, x) of the shifted image is pixel (y + shift, x + shift), cyclic
  uint firstWindowRow;    // of this dispatch, in the shifted image; window rows are cyclic too
  uint storeOrigin;       // vec4 index at which the target binding starts
  float epsilon;
};
const uint kSwinWindow = 8, kSwinTokens = 64;  // of a window, which is a workgroup's
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// A whole Swin layer ("STL", Hou & Liu 2023, figure 4) for matrix units, whose windows stay in shared memory:
/// u = t + WMSA(LN(t)); u + MLP(LN(u)), and with `grow` the 1x1 convolution of that. A fusion of LayerNorm, Linear and
/// WindowAttention, which say what the parts are.
struct SwinLayer {
  struct Map {
    std::span<const float> weight{}, bias{};  // [N][K], [N]
  };
  TensorView input, output;                           // [h, w, c], [h, w, N], both f16; h and w multiples of window
  Map norm1{}, norm2{};                               // [c] each
  Map qkv{}, proj{}, fc1{}, fc2{};                    // c -> 3c, c -> c, c -> m, m -> c
  Map grow{};                                         // optional, c -> N; without it N is c
  std::span<const float> biasTable;                   // [(2 window - 1)^2][heads], as that of WindowAttention
  uint32_t window = 8, headChannels = 32, shift = 0;  // shift is 0 or window / 2
  float epsilon = 1e-5f;
  RowRange rows{};  // of the output
};

/// [h, w, N]. Throws std::logic_error on sizes that do not fit each other.
TensorShape outputShape(const SwinLayer& op);

/// Whether the device has a kernel for it: matrix units, windows of 8 x 8, channels in sixteens, shared memory for a
/// window, and biases that halves hold well.
bool fits(const SwinLayer& op, const DeviceTraits& device);

/// Multiply-adds of the maps and, beside them, of the token pairs in attention, for the rows.
uint64_t mapMultiplyAdds(const SwinLayer& op);
uint64_t attentionMultiplyAdds(const SwinLayer& op);

/// The kernel launch over all windows that meet the rows, in software where the device has no matrix units. Only what
/// fits() can be run. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const SwinLayer& op, const DeviceTraits& device);

/// The maps as tiles of 16 x 16, see the kernel's head, with the norms multiplied into the maps behind them and `fc2`
/// into `grow`, in double precision.
std::vector<float> packedWeights(const SwinLayer& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const SwinLayer& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const SwinLayer& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const SwinLayer& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<SwinLayer>& examples);

}  // namespace xrds
#endif
#endif
