#ifndef XRDS_SHADERS_WINOGRAD_OUTPUT_H
#define XRDS_SHADERS_WINOGRAD_OUTPUT_H
#include "shaders/common/activation.h"
#include "shaders/common/winograd.h"

XRDS_SHARED_BEGIN
struct WinogradOutputParams {
  Slice source, residual, target;
  uint width;               // of the convolution
  uint rowBegin, rowEnd;    // of the convolution
  uint squares;             // of a row
  uint quads, targetQuads;  // channels of a plane and of the target, in fours
  uint shuffle;             // 2: a plane has four parts, (0, 0), (1, 0), (0, 1), (1, 1) of (x, y); or 1
  uint storeOrigin;         // vec4 index at which the target binding starts
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The last step of a 3x3 convolution by Winograd's F(4 x 4, 3 x 3): y = activation(pixels of the products + b) +
/// residual, 4 x 4 pixels of every square.
struct WinogradOutput {
  TensorView input;             // [ceil(h / 4), w / 4, 36 c]
  TensorView output;            // [h, w, c], w a multiple of 4
  TensorView residual{};        // optional, as the output; may be the output itself
  std::span<const float> bias;  // zero where it has none
  uint32_t firstOutput = 0;     // channel n is output firstOutput + n; if shuffled, outputs 4 (firstOutput + n) and on
  Activation activation = Activation::none;
  bool shuffleOutput = false;  // stores pixel_shuffle(result, 2): output [2h, 2w, c / 4]
  bool pooled = false;         // stores max_pool(result, 2), MaxPool: output [h / 2, w / 2, c]; not with a residual
  RowRange rows{};             // of the convolution, if pooled of the output; whole squares but at the image's end
  static constexpr uint32_t kRowUnit = shader::kWinogradSide;  // in which rows may be shared out among dispatches
};

/// [h, w, c], twice the sides and a quarter of the channels if shuffled, half the sides if pooled. Throws
/// std::logic_error if the input does not fit it.
TensorShape outputShape(const WinogradOutput& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const WinogradOutput& op, const DeviceTraits& device);

/// The bias, part by part if shuffled.
std::vector<float> packedWeights(const WinogradOutput& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const WinogradOutput& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const WinogradOutput& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const WinogradOutput& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<WinogradOutput>& examples);

}  // namespace xrds
#endif
#endif
