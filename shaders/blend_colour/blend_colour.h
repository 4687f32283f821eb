#ifndef XRDS_SHADERS_BLEND_COLOUR_H
#define XRDS_SHADERS_BLEND_COLOUR_H
#include "shaders/common/image.h"
#include "shaders/common/transfer.h"

XRDS_SHARED_BEGIN
struct BlendColourParams {
  Image base, images, aux, network, target;
  TargetRows rows;
  int exposure;  // texel of (e, 1 / e, ...)
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The base image with a share of the full-resolution colour H: (1 - g) base + g T(mean(e max(H, 0)) / (mean(a) +
/// 0.02)), both means over the m x m pixels around each with the same weights, exp of the network's logits; a is H's
/// own albedo, as noisy as H, and g the sigmoid of the logit behind those. Neighbours outside of the image take the
/// values of its border.
struct BlendColour {
  TensorView base;          // [>= H, >= W, 4]
  TensorView images;        // [>= H, >= W, k] the auxiliary images as given, H among them
  TensorView aux;           // [>= H, >= W, c] the same packed, a among them
  TensorView network;       // [>= H, >= W, >= firstLogit + m^2 + 1]
  TensorView exposure;      // [1, 1, 4] e, 1 / e
  TensorView output;        // [H, W, 4], the fourth channel zero
  int colourOffset = 0;     // first channel of H in images
  int albedoOffset = 0;     // first channel of a in aux
  uint32_t kernelSide = 3;  // m, odd
  uint32_t firstLogit = 3;  // channel of the network; logit j is of neighbour j, row-major, within +-8
  Transfer transfer = Transfer::none;
  RowRange rows{};
};

/// The shape of the output, which states H and W. Throws std::logic_error if an input does not hold it.
TensorShape outputShape(const BlendColour& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const BlendColour& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const BlendColour& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const BlendColour& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const BlendColour& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const BlendColour& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<BlendColour>& examples);

}  // namespace xrds
#endif
#endif
