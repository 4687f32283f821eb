#ifndef XRDS_SHADERS_ADD_EXCESS_H
#define XRDS_SHADERS_ADD_EXCESS_H
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
struct AddExcessParams {
  Image source, image, target;
  TargetRows rows;
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// What a denoiser that sees numbers from 0 to 1 made of an image, with what the image has outside of them: an albedo
/// has radiance above 1 where lights and the background are.
struct AddExcess {
  TensorView input;   // [h, w, 4], made of the image
  TensorView image;   // [h, w, 4]
  TensorView output;  // [h, w, 4]
  RowRange rows{};
};

/// [h, w, 4].
TensorShape outputShape(const AddExcess& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const AddExcess& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const AddExcess& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const AddExcess& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const AddExcess& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const AddExcess& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<AddExcess>& examples);

}  // namespace xrds
#endif
#endif
