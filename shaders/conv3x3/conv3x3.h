#ifndef XRDS_SHADERS_CONV3X3_H
#define XRDS_SHADERS_CONV3X3_H
#include "shaders/common/activation.h"

XRDS_SHARED_BEGIN
struct Conv3x3Params {
  Slice source, residual, target;
  uint width, height;       // of the convolution: an unshuffled input has twice, a shuffled output gets twice that
  uint rowBegin, rowEnd;    // of the convolution
  uint inputChannels;       // of the source; an unshuffled one stands for four times as many
  uint outputChannels;      // of the target; a shuffled one takes four times as many
  uint unshuffle, shuffle;  // 2, or 1 for none
  uint storeOrigin;         // vec4 index at which the target binding starts
  uint seenWidth;           // columns of the convolution's input from there on are read as zero
};
const uint kConv3x3Pixels = 4;  // pixels of an invocation of the plain kernel, side by side
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// y = activation(x * w + b) + residual, a 3x3 convolution with zero padding of one pixel.
/// Views of 3 or 6 channels are padded to a multiple of 4: weights of padded inputs count as zero, padded outputs are
/// written as activation(0).
struct Conv3x3 {
  TensorView input, output;
  TensorView residual{};                           // optional, as the output; may be the output itself
  std::span<const float> weight, bias;             // OIHW [outputChannels][inputChannels][3][3], [outputChannels]
  uint32_t inputChannels = 0, outputChannels = 0;  // of the weight
  Activation activation = Activation::none;
  bool unshuffleInput = false;  // convolves pixel_unshuffle(input, 2): input [2h, 2w, inputChannels / 4]
  bool shuffleOutput = false;   // stores pixel_shuffle(result, 2): output [2h, 2w, outputChannels / 4]
  // Results are rounded per aligned group of 4 pixels of a row.
  bool inFours = false;
  DataType weightType = DataType::f32;  // storage of the packed weights
  RowRange rows{};                      // of the convolution, before a shuffle
  // Columns of the convolution's input that it sees, at least 1; those behind are read as zero. 0: all.
  uint32_t seenColumns = 0;
};

/// [h, w, outputChannels] (twice the sides and a quarter of the channels if shuffled), channels rounded up to 4.
/// Throws std::logic_error if input, weight and bias do not fit each other.
TensorShape outputShape(const Conv3x3& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const Conv3x3& op, const DeviceTraits& device);

/// Shapes of the device's family that are worth a try beside the rule's own: outputs and rows of a lane, rows of a
/// workgroup and pixels of an invocation (as outputs) of the tile kernel, fragments of a workgroup of the matrix
/// kernel.
std::vector<KernelShape> shapesToTry(const Conv3x3& op, const DeviceTraits& device);

/// Double precision, in reads as its weights; the kernels' heads give the layouts. A shuffled channel c, y, x stands
/// at (2 y + x) * channels + c, so that four in a row belong to one pixel.
std::vector<float> packedWeights(const Conv3x3& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const Conv3x3& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const Conv3x3& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const Conv3x3& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<Conv3x3>& examples);

}  // namespace xrds
#endif
#endif
