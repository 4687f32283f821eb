#ifndef XRDS_SHADERS_WINOGRAD_PRODUCTS_H
#define XRDS_SHADERS_WINOGRAD_PRODUCTS_H
#include "shaders/common/winograd.h"

XRDS_SHARED_BEGIN
struct WinogradProductsParams {
  Slice source, target;
  uint squareBegin, squareEnd;
  uint inputQuads, outputQuads;  // of a plane
  uint firstQuads;               // of the inputs those that lie in planes before the others'
  uint storeOrigin;              // vec4 index at which the target binding starts
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The second step of a 3x3 convolution by Winograd's F(4 x 4, 3 x 3): a linear map of each of the 36 planes of a
/// square, whose weights stand in place of the convolution's.
struct WinogradProducts {
  TensorView input, output;                        // [h, w, 36 K], [h, w, 36 N]: squares
  uint32_t firstInputs = 0;                        // the planes of the first so many channels lie before the others'
  std::span<const float> weight;                   // of the convolution, OIHW [outputChannels][inputChannels][3][3]
  uint32_t inputChannels = 0, outputChannels = 0;  // of the weight; inputs from there to K count as zero
  uint32_t firstOutput = 0;                        // channel n of a plane is output firstOutput + n
  // Part by part, as WinogradOutput shuffles: channel part N / 4 + n is output 4 (firstOutput + n) + part.
  bool shuffled = false;
  RowRange rows{};
};

/// [h, w, 36 N], N being the channels of the output's planes: outputs that the weight has not are zero. Throws
/// std::logic_error if the weight does not fit.
TensorShape outputShape(const WinogradProducts& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const WinogradProducts& op, const DeviceTraits& device);

/// Shapes of the device's family that are worth a try beside the rule's own: outputs of a lane, the other order.
std::vector<KernelShape> shapesToTry(const WinogradProducts& op, const DeviceTraits& device);

/// Made in double precision. For each plane [K][N], for the lane kernel as laneWeightAt() says.
std::vector<float> packedWeights(const WinogradProducts& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const WinogradProducts& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const WinogradProducts& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const WinogradProducts& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<WinogradProducts>& examples);

}  // namespace xrds
#endif
#endif
