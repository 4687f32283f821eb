#ifndef XRDS_SHADERS_FILTER_AUXILIARY_H
#define XRDS_SHADERS_FILTER_AUXILIARY_H
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
struct FilterAuxiliaryParams {
  Image aux, network, target;
  TargetRows rows;
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The auxiliary images without their noise: the mean of the m x m pixels around each, weighted by exp of the network's
/// logits. Neighbours outside of the real image take the values of its border.
struct FilterAuxiliary {
  TensorView aux;           // [>= H, >= W, c]; only its first H x W pixels are read
  TensorView network;       // [>= H, >= W, >= firstLogit + m^2]
  TensorView output;        // [H, W, c]
  uint32_t kernelSide = 3;  // m, odd
  uint32_t firstLogit = 3;  // channel of the network; logit j is of neighbour j, row-major, within +-8
  RowRange rows{};
};

/// The shape of the output, which states H and W. Throws std::logic_error if an input does not hold it.
TensorShape outputShape(const FilterAuxiliary& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const FilterAuxiliary& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const FilterAuxiliary& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const FilterAuxiliary& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const FilterAuxiliary& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const FilterAuxiliary& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<FilterAuxiliary>& examples);

}  // namespace xrds
#endif
#endif
