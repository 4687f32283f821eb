#ifndef XRDS_SHADERS_LINEAR_H
#define XRDS_SHADERS_LINEAR_H
#include "shaders/common/activation.h"

XRDS_SHARED_BEGIN
struct LinearParams {
  Slice source, appended, residual, target;
  uint sourceChannels;                 // those behind them are of `appended`
  uint inputChannels, outputChannels;  // of both; of the target
  uint tokenBegin;                     // first token of this dispatch
  uint tokenEnd;
  uint storeOrigin;  // vec4 index at which the target binding starts
  float epsilon;
};
const uint kLinearTokens = 4;       // tokens of an invocation of the plain kernel
const uint kLinearTileInputs = 16;  // input channels of a step of the tile kernel
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// y = activation(x W^T + b) + residual for every token, which is also the 1x1 convolution of an image. With a norm of
/// LN(x) in place of x, see LayerNorm; with a first map of x V^T + c.
struct Linear {
  TensorView input, output;             // [h, w, K], [h, w, N rounded up to a multiple of four]
  TensorView appended{};                // optional [h, w, L]: channels behind those of the input; K is then K + L
  TensorView residual{};                // optional, as the output, which it may be
  std::span<const float> weight, bias;  // [N][K], with a first map [N][M]; [N]
  struct Norm {
    std::span<const float> weight{}, bias{};  // [K] each; empty: none
    float epsilon = 1e-5f;
  } norm{};
  struct Map {
    std::span<const float> weight{}, bias{};  // V [M][K], c [M]; empty: none, as it is where there is a norm
  } first{};
  Activation activation = Activation::none;
  DataType weightType = DataType::f32;  // storage of the packed weights
  RowRange rows{};                      // of the output
};

/// K: the channels of the input and of what is appended.
inline uint32_t inputChannels(const Linear& op) { return op.input.channels + op.appended.channels; }

/// [h, w, N], N being the length of the bias, rounded up to a multiple of four; the channels above it get
/// activation(0). Throws std::logic_error if the weight or what is appended does not fit.
TensorShape outputShape(const Linear& op);

/// The kernel launch for the rows. The lane kernel takes four outputs and multiples of eight if the weights of eight
/// fit its tile, the tile kernel all that the limits of the device allow; all else, and a norm that is not for the lane
/// kernel, goes to the plain one. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const Linear& op, const DeviceTraits& device);

/// Shapes of the device's family that are worth a try beside the rule's own: outputs of a lane, in turns or at once;
/// tokens of an invocation of the tile kernel; fragments of a workgroup of the matrix kernel.
std::vector<KernelShape> shapesToTry(const Linear& op, const DeviceTraits& device);

/// [N][K] and [N] of the map, into which those of a norm or of a first map are multiplied, in double precision.
std::vector<float> joinedWeight(const Linear& op);
std::vector<float> joinedBias(const Linear& op);

/// What the chosen kernel reads as its weights, of the joined ones. Plain, tile: [K][N], then bias[N]. Lane: the same
/// K + 1 rows as laneWeightAt() says.
std::vector<float> packedWeights(const Linear& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const Linear& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const Linear& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const Linear& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<Linear>& examples);

}  // namespace xrds
#endif
#endif
