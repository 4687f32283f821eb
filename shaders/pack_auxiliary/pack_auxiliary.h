#ifndef XRDS_SHADERS_PACK_AUXILIARY_H
#define XRDS_SHADERS_PACK_AUXILIARY_H
#include "shaders/common/image.h"
#include "shaders/common/transfer.h"

XRDS_SHARED_BEGIN
struct PackAuxiliaryParams {
  Image source, target;
  TargetRows rows;
  int exposure;  // texel of (e, 1 / e, ...)
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// The auxiliary images as the network reads them: padded on the right and at the bottom by edge replication, the
/// albedo a clamped to [0, 4], the full-resolution colour H as T(e max(H, 0) / (a + 0.02)) or T(e max(H, 0)), light L
/// without albedo as T(e max(L, 0)), the rest clamped to +-65504, in the type of the output.
struct PackAuxiliary {
  TensorView input, output;  // [H, W, c], [Hp, Wp, c]
  int albedoOffset = -1;     // first channel of the albedo; -1: there is none
  int colourOffset = -1;     // the same of the colour
  uint32_t lightChannels{};  // bit c: channel c is light without albedo
  TensorView exposure{};     // [1, 1, 4] e, 1 / e; needed, as what follows, where there is colour or light
  bool demodulates = false;  // whether the colour is divided by the albedo
  Transfer transfer = Transfer::none;
  RowRange rows{};

  bool takesRadiance() const { return colourOffset >= 0 || lightChannels != 0; }
};

/// The shape of the output, whose size states the padding. Throws std::logic_error if the input does not fit it.
TensorShape outputShape(const PackAuxiliary& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const PackAuxiliary& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const PackAuxiliary& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const PackAuxiliary& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const PackAuxiliary& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const PackAuxiliary& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<PackAuxiliary>& examples);

}  // namespace xrds
#endif
#endif
