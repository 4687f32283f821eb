#ifndef XRDS_SHADERS_WINOGRAD_INPUT_H
#define XRDS_SHADERS_WINOGRAD_INPUT_H
#include "shaders/common/winograd.h"

XRDS_SHARED_BEGIN
struct WinogradInputParams {
  Slice source, target;
  uint width, height;     // of the image
  uint seenWidth;         // columns from there on are read as zero
  uint squares;           // of a row
  uint rowBegin, rowEnd;  // of squares
  uint quads;             // channels of the image, in fours
  uint storeOrigin;       // vec4 index at which the target binding starts
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The first step of a 3x3 convolution by Winograd's F(4 x 4, 3 x 3): for every square of 4 x 4 pixels, what stands in
/// place of the 6 x 6 pixels that its results read. Pixels outside of the image are zero.
struct WinogradInput {
  TensorView input;          // [h, w, c], w a multiple of 4
  TensorView output;         // [ceil(h / 4), w / 4, 36 c]: 36 planes of c channels
  RowRange rows{};           // of the output
  uint32_t seenColumns = 0;  // as of Conv3x3
  bool upsampled = false;    // the input is [h / 2, w / 2, c], and the image what UpsampleNearest makes of it
};

/// [ceil(h / 4), w / 4, 36 c]. Throws std::logic_error if the width is no multiple of 4.
TensorShape outputShape(const WinogradInput& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const WinogradInput& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const WinogradInput& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const WinogradInput& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const WinogradInput& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const WinogradInput& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<WinogradInput>& examples);

}  // namespace xrds
#endif
#endif
