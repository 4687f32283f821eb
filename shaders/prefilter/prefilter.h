#ifndef XRDS_SHADERS_PREFILTER_H
#define XRDS_SHADERS_PREFILTER_H
#include "shaders/common/image.h"
#include "shaders/common/transfer.h"

XRDS_SHARED_BEGIN
const int kPrefilterLevels = 3;      // at most
const int kPrefilterStep = 3;        // of a level, in steps of the one below
const int kPrefilterTaps = 25;       // of a level
const float kSigmaPrefilter = 1.8f;  // of the spatial weights, in steps of the level

struct PrefilterParams {
  Image colour, auxMean, coarser, logits, target;
  TargetRows rows;
  int exposure;  // texel of (e, 1 / e, ...)
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/guides.h"
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The low-resolution colour without most of its noise, transformed: T(mean(e max(I, 0)) / (mean(b) + 0.02)), both
/// means with the same weights over the 25 taps of each level: 5 x 5 pixels, 3^k apart, of the images of level k, the
/// means of 3^k x 3^k pixels (DilatedMean). A weight is exp(-d^2 / (2 1.8^2)) of the distance in steps, times how much
/// albedo and normal of the tap resemble those of the pixel at level 0, as in JointBilateral, times exp of a learned
/// logit. Taps outside of the image take the values of the level's border.
struct Prefilter {
  TensorView colour;     // [>= h, >= w, 4] linear radiance I
  TensorView auxMean;    // [>= h, >= w, c] albedo b, normal m
  TensorView coarser{};  // [>= h, >= w, (levels - 1) (4 + c)] both of level 1, both of level 2; one level needs none
  TensorView logits;     // [>= h, >= w, >= 25 levels]: channel 25 k + j is that of tap j, row-major, within +-8
  TensorView exposure;   // [1, 1, 4] e, 1 / e
  TensorView output;     // [h, w, 4], the fourth channel zero
  uint32_t levels = 1;   // 1, 2 or 3
  int albedoOffset = 0;
  int normalOffset = -1;  // -1: no normals, their term is 1
  Transfer transfer = Transfer::none;
  RowRange rows{};
};

/// The shape of the output, which states h and w. Throws std::logic_error if an input does not hold it.
TensorShape outputShape(const Prefilter& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const Prefilter& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const Prefilter& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const Prefilter& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const Prefilter& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const Prefilter& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<Prefilter>& examples);

}  // namespace xrds
#endif
#endif
