#ifndef XRDS_SHADERS_BICUBIC_H
#define XRDS_SHADERS_BICUBIC_H
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
struct BicubicParams {
  Image source, target;
  TargetRows rows;
  int firstRow;  // of the first run; may lie above the image
};

const float kBicubicParameter = -0.75f;
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// Cubic upsampling with parameter -0.75, half-pixel centres and edge replication.
struct Bicubic {
  TensorView input;    // [>= h, >= w, 4]; only its first h x w pixels are read, as the image's own border is replicated
  TensorView output;   // [s h, s w, 4]
  uint32_t scale = 1;  // s: 1, 2, 4, 8 or 16
  RowRange rows{};
};

/// The shape of the output, which states h and w. Throws std::logic_error if it is no multiple of the scale or the
/// input is smaller than h x w.
TensorShape outputShape(const Bicubic& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const Bicubic& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const Bicubic& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const Bicubic& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const Bicubic& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const Bicubic& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<Bicubic>& examples);

}  // namespace xrds
#endif
#endif
