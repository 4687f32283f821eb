#include "shaders/joint_bilateral/joint_bilateral.h"

#include <algorithm>
#include <cmath>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

// How many pixels of a column share the loads of their neighbours; two, where the registers of four are not there.
// Where subgroups take turns, longer code costs nothing, and the pixels may be of several low-resolution ones.
uint32_t runLength(const JointBilateral& op, RowRange rows, const DeviceTraits& device) {
  constexpr uint32_t kOfFour = 192;  // registers
  const uint32_t most = device.registers < kOfFour ? 2 : 4;
  const bool inTurns = device.family == KernelFamily::lane;
  const uint32_t ofRows = (rows.begin | rows.end) & -(rows.begin | rows.end);
  return std::min(most, inTurns ? std::max(op.scale, ofRows) : op.scale);
}

void referencePixel(const JointBilateral& op, HostMemory& memory, uint32_t y, uint32_t x) {
  const double s = op.scale;
  const int h = static_cast<int>(op.output.height / op.scale), w = static_cast<int>(op.output.width / op.scale);
  const double qy = (y + 0.5) / s - 0.5, qx = (x + 0.5) / s - 0.5;
  double sum[3] = {}, total = 0;
  for (int j = 0; j < 25; ++j) {
    const int iy = static_cast<int>(y / op.scale) + j / 5 - 2, ix = static_cast<int>(x / op.scale) + j % 5 - 2;
    const uint32_t ny = std::clamp(iy, 0, h - 1), nx = std::clamp(ix, 0, w - 1);
    const double space = std::exp(-((qy - iy) * (qy - iy) + (qx - ix) * (qx - ix)) / (2 * 0.75 * 0.75));
    const auto own = [&](uint32_t c) { return memory.at(op.aux, y, x, c); };
    const auto neighbours = [&](uint32_t c) { return memory.at(op.auxMean, ny, nx, c); };
    double weight = space * (likeness(op.albedoOffset, op.normalOffset, own, neighbours) + 1e-6);
    if (op.network.exists())
      weight *= std::exp(std::clamp(memory.at(op.network, y, x, shader::kFirstLogit + j), -8.0, 8.0));
    for (uint32_t c = 0; c < 3; ++c) sum[c] += weight * memory.at(op.input, ny, nx, c);
    total += weight;
  }
  for (uint32_t c = 0; c < 3; ++c) memory.at(op.output, y, x, c) = sum[c] / total;
  memory.at(op.output, y, x, 3) = 0;
}

}  // namespace

TensorShape outputShape(const JointBilateral& op) {
  checkHolds(op.output, {1, 1, 4});
  checkScale(op.scale);
  XRDS_CHECK_EQ(op.output.height % op.scale, 0u);
  XRDS_CHECK_EQ(op.output.width % op.scale, 0u);
  XRDS_CHECK_LE(0, op.albedoOffset);
  XRDS_CHECK_LE(-1, op.normalOffset);
  const uint32_t h = op.output.height / op.scale, w = op.output.width / op.scale;
  const uint32_t auxChannels = std::max(op.albedoOffset, op.normalOffset) + 3;
  checkHolds(op.input, {h, w, 4});
  checkHolds(op.aux, {op.output.height, op.output.width, auxChannels});
  checkHolds(op.auxMean, {h, w, auxChannels});
  if (op.network.exists()) checkHolds(op.network, {op.output.height, op.output.width, shader::kFirstLogit + 25u});
  return {op.output.height, op.output.width, 4};
}

Dispatch dispatch(const JointBilateral& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const uint32_t run = runLength(op, rows, device);
  const bool learned = op.network.exists();
  const TensorView& network = learned ? op.network : op.input;  // an unread binding must still name something
  const shader::JointBilateralParams params{imageOf(op.input), imageOf(op.aux),    imageOf(op.auxMean),
                                            imageOf(network),  imageOf(op.output), targetRows(op.output, rows)};
  return imageDispatch(
      "joint_bilateral", device, op.output, rows, run, params,
      {op.scale, run, static_cast<uint32_t>(op.albedoOffset), static_cast<uint32_t>(op.normalOffset), learned},
      {readTexels(op.input), readTexels(op.aux), readTexels(op.auxMean), readTexels(network),
       writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const JointBilateral&, const DeviceTraits&) { return {}; }

void reference(const JointBilateral& op, HostMemory& memory) {
  outputShape(op);
  const RowRange rows = resolve(op.rows, op.output.height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < op.output.width; ++x) referencePixel(op, memory, y, x);
}

OperatorFacts facts(const JointBilateral& op) {
  return {"joint_bilateral", {{op.input, 2}, op.aux, {op.auxMean, 2}, op.network}, {1e-6, 1e-6}};
}

// Stored in fp32 always.
void propagate(const JointBilateral&, Moments&) {}

void addExamples(ExampleMaker& maker, std::vector<JointBilateral>& examples) {
  examples.push_back({.input = maker.view({8, 8, 4}, DataType::f32),
                      .aux = maker.view({16, 16, 8}),
                      .auxMean = maker.view({8, 8, 8}, DataType::f32),
                      .network = maker.view({16, 16, 28}),
                      .output = maker.view({16, 16, 4}, DataType::f32),
                      .albedoOffset = 0,
                      .normalOffset = 3,
                      .scale = 2});
}

}  // namespace xrds
