#include "shaders/follow_motion/follow_motion.h"

#include <algorithm>
#include <cmath>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

void referencePixel(const FollowMotion& op, HostMemory& memory, uint32_t y, uint32_t x) {
  double q[3] = {double(x), double(y), 1};
  if (op.positions.exists())
    for (uint32_t c = 0; c < 3; ++c) q[c] = memory.at(op.positions, y, x, c);
  const double last[2] = {op.output.width - 1.0, op.output.height - 1.0};
  uint32_t from[2];
  for (int c = 0; c < 2; ++c) from[c] = static_cast<uint32_t>(std::clamp(std::floor(q[c] + 0.5), 0.0, last[c]));
  for (uint32_t c = 0; c < 2; ++c) {
    const double next = q[c] + memory.at(op.motion, from[1], from[0], c);
    memory.at(op.output, y, x, c) = next;
    if (next <= -0.5 || next >= last[c] + 0.5) q[2] = 0;
  }
  memory.at(op.output, y, x, 2) = q[2];
  memory.at(op.output, y, x, 3) = 0;
}

}  // namespace

TensorShape outputShape(const FollowMotion& op) {
  checkView(op.motion, {op.motion.height, op.motion.width, 4});
  if (op.positions.exists()) checkView(op.positions, op.motion.shape());
  return op.motion.shape();
}

Dispatch dispatch(const FollowMotion& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const bool first = !op.positions.exists();
  const TensorView& positions = first ? op.motion : op.positions;  // something must be bound
  const shader::FollowMotionParams params{imageOf(positions), imageOf(op.motion), imageOf(op.output),
                                          targetRows(op.output, rows)};
  return imageDispatch("follow_motion", device, op.output, rows, 1, params, {first},
                       {readTexels(positions), readTexels(op.motion), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const FollowMotion&, const DeviceTraits&) { return {}; }

void reference(const FollowMotion& op, HostMemory& memory) {
  outputShape(op);
  const RowRange rows = resolve(op.rows, op.output.height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < op.output.width; ++x) referencePixel(op, memory, y, x);
}

OperatorFacts facts(const FollowMotion& op) {
  return {"follow_motion", {op.positions, {op.motion, std::max(op.motion.width, op.motion.height)}}, kRoundedBudget};
}

void propagate(const FollowMotion&, Moments&) {}

void addExamples(ExampleMaker& maker, std::vector<FollowMotion>& examples) {
  examples.push_back({.positions = maker.view({16, 16, 4}, DataType::f32),
                      .motion = maker.view({16, 16, 4}, DataType::f32),
                      .output = maker.view({16, 16, 4}, DataType::f32)});
}

}  // namespace xrds
