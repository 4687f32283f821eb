#include "shaders/winograd_products/winograd_products.h"

#include <algorithm>

#include "shaders/common/example.h"
#include "shaders/common/groups.h"
#include "shaders/common/lane_products.h"
#include "shaders/common/moments.h"
#include "shaders/common/uniform_store.h"

namespace xrds {
namespace {

constexpr uint32_t kPlanes = shader::kWinogradPlanes;
// Of the lane kernel: multiply-adds of a lane, of which more take long to compile, and outputs.
constexpr uint32_t kMaxBody = 8192, kMaxTile = 64;
constexpr uint32_t kMaxSubgroups = 32;  // of a workgroup of the lane kernel

// Channels of a plane.
uint32_t inputs(const WinogradProducts& op) { return op.input.channels / kPlanes; }
uint32_t outputs(const WinogradProducts& op) { return op.output.channels / kPlanes; }

// Where an input of a plane is in the channels of a square.
uint32_t inputAt(const WinogradProducts& op, uint32_t plane, uint32_t k) {
  const uint32_t first = op.firstInputs;
  return k < first ? plane * first + k : kPlanes * first + plane * (inputs(op) - first) + k - first;
}

// Whether the lane kernel does, eight outputs after the other in a loop. Its weights are of fp32 always.
bool readsWeightsByAddress(const WinogradProducts& op, const DeviceTraits& device) {
  return readsWeightsByAddress(device, op.output.type, DataType::f32);
}

// Outputs of a workgroup of the lane kernel; 0: the device takes the plain one.
uint32_t laneTile(const WinogradProducts& op, const DeviceTraits& device) {
  const uint32_t step = outputs(op) % 8 == 0 ? 8 : 4;
  if (device.family != KernelFamily::lane || !device.shaderInt64 ||
      device.subgroupSize * kMaxSubgroups > device.maxGroupInvocations)
    return 0;
  const bool byAddress = readsWeightsByAddress(op, device);
  const auto fits = [&](uint32_t tile) {
    return outputs(op) % tile == 0 &&
           (byAddress || (inputs(op) * tile <= kMaxBody && inputs(op) * tile * 4 <= device.maxSharedBytes));
  };
  if (const uint32_t asked = device.shape.outputs; asked > 0 && asked % step == 0 && fits(asked)) return asked;
  const uint32_t most = byAddress ? outputs(op) : std::min(kMaxTile, outputs(op));
  for (uint32_t tile = most / step * step; tile > 0; tile -= step)
    if (fits(tile)) return tile;
  return 0;
}

// Subgroups of a workgroup, a power of two. All of it stages the weights, which takes about as long as the products of
// one subgroup and a half; those behind the last square are in vain.
uint32_t groupSubgroups(uint32_t subgroups) {
  uint32_t best = kMaxSubgroups;
  const auto cost = [&](uint32_t count) { return ceilDivide(subgroups, count) * (2 * count + 3); };
  for (uint32_t count = kMaxSubgroups; count > 0; count /= 2)
    if (cost(count) < cost(best)) best = count;
  return best;
}

// Whether the subgroups of a workgroup of the lane kernel take turns, eight outputs each, by which Mesa 25.0 gains
// nothing.
bool takesTurns(const WinogradProducts& op, const DeviceTraits& device) {
  if (laneTile(op, device) <= 8) return false;  // one turn
  if (device.shape.rows > 0) return device.shape.rows == kInTurns;
  return device.laneCode == LaneCode::shuffles && gainsByTurns(device, kMaxSubgroups, inputs(op));
}

std::array<double, 9> tapsOf(const WinogradProducts& op, uint32_t n, uint32_t k) {
  std::array<double, 9> taps{};
  const uint32_t part = outputs(op) / 4, first = op.firstOutput;
  const uint32_t output = op.shuffled ? 4 * (first + n % part) + n / part : first + n;
  if (output >= op.outputChannels || k >= op.inputChannels) return taps;
  std::copy_n(op.weight.begin() + (size_t{output} * op.inputChannels + k) * 9, 9, taps.begin());
  return taps;
}

}  // namespace

TensorShape outputShape(const WinogradProducts& op) {
  checkView(op.input, op.input.shape());
  XRDS_CHECK_EQ(op.input.channels % (4 * kPlanes), 0u);
  XRDS_CHECK_EQ(op.output.channels % (4 * kPlanes), 0u);
  XRDS_CHECK_LE(op.inputChannels, inputs(op));
  XRDS_CHECK_LE(op.firstInputs, inputs(op));
  XRDS_CHECK_EQ(op.firstInputs % 4, 0u);
  XRDS_CHECK_EQ(op.weight.size(), size_t{op.outputChannels} * op.inputChannels * 9);
  return {op.input.height, op.input.width, op.output.channels};
}

Dispatch dispatch(const WinogradProducts& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::WinogradProductsParams params{.source = sliceOf(op.input),
                                              .target = sliceOf(op.output),
                                              .squareBegin = rows.begin * op.input.width,
                                              .squareEnd = rows.end * op.input.width,
                                              .inputQuads = inputs(op) / 4,
                                              .outputQuads = outputs(op) / 4,
                                              .firstQuads = op.firstInputs / 4,
                                              .storeOrigin = storeOrigin(op.output, rows)};
  const uint32_t squares = params.squareEnd - params.squareBegin;
  Dispatch launch{.bindings = {readTexels(op.input), readWeights(DataType::f32), writeRows(op.output, rows)},
                  .pushConstants = pushBytes(params),
                  .multiplyAdds = facts(op).multiplyAdds};
  launch.savedProducts = launch.multiplyAdds - launch.multiplyAdds / 4;  // 36 of 16 * 9
  if (const uint32_t tile = laneTile(op, device)) {
    const uint32_t subgroups = groupSubgroups(ceilDivide(squares, device.subgroupSize));
    const uint32_t inEights = (params.target.offset | params.target.stride | params.storeOrigin | tile / 4) % 2 == 0;
    launch.program = programName("winograd_products", KernelFamily::lane, op.output.type);
    launch.specialization = {device.subgroupSize,   subgroups, inputs(op), tile, inEights, op.firstInputs,
                             takesTurns(op, device)};
    launch.pushConstants = pushBytesWithDigits(params);
    if (readsWeightsByAddress(op, device)) readWeightsByAddress(launch);
    launch.groupCount = {op.output.channels / tile, ceilDivide(squares, device.subgroupSize * subgroups), 1};
  } else {
    launch.program = programName("winograd_products", KernelFamily::plain, op.output.type);
    launch.groupCount = foldedGroups(ceilDivide(uint64_t{squares} * (op.output.channels / 4), 64));
  }
  return launch;
}

std::vector<KernelShape> shapesToTry(const WinogradProducts& op, const DeviceTraits& device) {
  std::vector<KernelShape> shapes;
  if (laneTile(op, device) == 0) return shapes;
  for (const uint32_t tile : {8U, 12U, 16U, 20U, 32U, 36U, 48U, 64U})
    if (outputs(op) % tile == 0) shapes.push_back({.outputs = tile});
  if (laneTile(op, device) > 8 && !readsWeightsByAddress(op, device))
    shapes.push_back({.rows = takesTurns(op, device) ? kAtOnce : kInTurns});
  return shapes;
}

std::vector<float> packedWeights(const WinogradProducts& op, const DeviceTraits& device) {
  const uint32_t laneOutputs = laneTile(op, device), n = outputs(op), k = inputs(op);
  std::vector<float> packed(size_t{kPlanes} * n * k);
  for (uint32_t o = 0; o < n; ++o)
    for (uint32_t i = 0; i < k; ++i) {
      const std::array<double, kPlanes> made = winogradWeights(tapsOf(op, o, i));
      const size_t at = laneOutputs > 0 ? laneWeightAt(o, i, k, laneOutputs) : size_t{i} * n + o;
      for (uint32_t e = 0; e < kPlanes; ++e) packed[size_t{e} * n * k + at] = static_cast<float>(made[e]);
    }
  return packed;
}

void reference(const WinogradProducts& op, HostMemory& memory) {
  const auto [height, width, planes] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  const uint32_t n = outputs(op), k = inputs(op);
  std::vector<std::array<double, kPlanes>> weights;
  for (uint32_t i = 0; i < n * k; ++i) weights.push_back(winogradWeights(tapsOf(op, i / k, i % k)));
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t e = 0; e < kPlanes; ++e)
        for (uint32_t o = 0; o < n; ++o) {
          double sum = 0;
          for (uint32_t i = 0; i < k; ++i) sum += memory.at(op.input, y, x, inputAt(op, e, i)) * weights[o * k + i][e];
          memory.at(op.output, y, x, e * n + o) = sum;
        }
}

// Of the convolution: 16 pixels a square.
OperatorFacts facts(const WinogradProducts& op) {
  return {.name = "winograd_products",
          .inputs = {op.input},
          .budget = {1e-6, 8e-4},
          .multiplyAdds = computedPixels(op) * 16 * 9 * op.inputChannels * outputs(op)};
}

void propagate(const WinogradProducts& op, Moments& moments) {
  const uint32_t n = outputs(op), k = inputs(op);
  for (uint32_t o = 0; o < n; ++o) {
    std::array<Moment, kPlanes> sums{};
    for (uint32_t i = 0; i < k; ++i) {
      const std::array<double, kPlanes> w = winogradWeights(tapsOf(op, o, i));
      for (uint32_t e = 0; e < kPlanes; ++e) {
        const Moment x = moments.at(op.input, inputAt(op, e, i));
        sums[e] = sums[e] + Moment{w[e] * x.mean, w[e] * w[e] * x.variance};
      }
    }
    for (uint32_t e = 0; e < kPlanes; ++e) moments.at(op.output, e * n + o) = sums[e];
  }
}

void addExamples(ExampleMaker& maker, std::vector<WinogradProducts>& examples) {
  if (maker.device().family != KernelFamily::lane) return;  // which the others leave out
  WinogradProducts op{.input = maker.view({4, 8, 576}, DataType::f32),
                      .output = maker.view({4, 8, 1152}, DataType::f32)};
  op.weight = maker.weights(size_t{16} * 32 * 9);
  op.inputChannels = 16;
  op.outputChannels = 32;
  examples.push_back(op);
  op.firstInputs = 12;
  examples.push_back(op);
}

}  // namespace xrds
