#ifndef XRDS_SHADERS_FOLLOW_MOTION_H
#define XRDS_SHADERS_FOLLOW_MOTION_H
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
struct FollowMotionParams {
  Image positions, motion, target;
  TargetRows rows;
};
XRDS_SHARED_END

#ifdef __cplusplus
#include "shaders/common/operator_facts.h"
namespace xrds {

/// Where what each pixel shows was one frame on: (x, y, 1, 0) in pixels, centres at whole numbers, of q + m(q) for the
/// position q so far and the motion m at the pixel next to it; the third channel is 0 where the way has left the image.
struct FollowMotion {
  TensorView positions;  // [H, W, 4] as the output; absent: each pixel's own
  TensorView motion;     // [H, W, 4] x to the right and y down, in pixels; of the frame in which q lies
  TensorView output;     // [H, W, 4]
  RowRange rows{};
};

/// That of the motion. Throws std::logic_error if the positions are of another shape.
TensorShape outputShape(const FollowMotion& op);

/// The kernel launch for the rows. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const FollowMotion& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const FollowMotion& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const FollowMotion& op, HostMemory& memory);

/// What the rest of the house asks of it. It may read the motion anywhere.
OperatorFacts facts(const FollowMotion& op);

/// Stored in fp32 always.
void propagate(const FollowMotion& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<FollowMotion>& examples);

}  // namespace xrds
#endif
#endif
