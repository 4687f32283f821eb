#ifndef XRDS_SHADERS_JOINT_BILATERAL_H
#define XRDS_SHADERS_JOINT_BILATERAL_H
#include "shaders/common/guides.h"
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
struct JointBilateralParams {
  Image source, aux, auxMean, network, target;
  TargetRows rows;
};

const float kSigmaSpace = 0.75f;  // in low-resolution pixels
const int kFirstLogit = 3;        // channel of the network's output
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The guided base image: the mean of the 5 x 5 low-resolution neighbours of a pixel, weighted by distance and by how
/// much their albedo and normal resemble the pixel's own, times exp of a learned logit where there is a network.
/// Neighbours outside of the image take the values of its border and keep their own distance.
struct JointBilateral {
  TensorView input;      // [>= h, >= w, 4] x; only its first h x w pixels are read
  TensorView aux;        // [Hp, Wp, c] albedo a, normal n
  TensorView auxMean;    // [hp, wp, c] b, m
  TensorView network{};  // optional [Hp, Wp, >= 28]: channel 3 + j is the logit of neighbour j, row-major, within +-8
  TensorView output;     // [s h, s w, 4], the fourth channel zero
  int albedoOffset = 0;
  int normalOffset = -1;  // -1: no normals, their term is 1
  uint32_t scale = 1;     // s: 1, 2, 4, 8 or 16
  RowRange rows{};
};

/// The shape of the output, which states h and w. Throws std::logic_error if an input does not fit it.
TensorShape outputShape(const JointBilateral& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const JointBilateral& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const JointBilateral& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const JointBilateral& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const JointBilateral& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const JointBilateral& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<JointBilateral>& examples);

}  // namespace xrds
#endif
#endif
