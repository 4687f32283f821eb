#include "checks/matrix_proof.h"

#include <random>

#include "checks/placed_operator.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint32_t kSide = 20, kChannels = 48;  // several workgroups, and fragments that are not full
constexpr uint32_t kLayerSide = 16, kLayerChannels = 32, kHeadChannels = 16;

std::vector<float> halves(size_t count) {
  std::minstd_rand random(1);
  std::vector<float> numbers(count);
  for (float& number : numbers) number = static_cast<float>(static_cast<int>(random() % 513) - 256) / 256;
  return numbers;
}

bool isRight(Gpu& gpu, const Operator& op) {
  Graph graph;
  graph.nodes.push_back({"matrix_proof", op});
  const TensorShape shape = outputOf(graph.nodes.front()).shape();
  for (const char* name : {"input", "output"}) graph.create(name, DataType::f16, shape);
  const PlacedOperator placed(gpu, graph);
  Recording(gpu, placed.dispatches()).run();
  return placed.error().withinTolerance;
}

// Values 0 and 1 of a graph.
TensorView viewOf(ValueId value, uint32_t side, uint32_t channels) {
  return {value, DataType::f16, side, side, channels, 0, channels};
}

bool areRight(Gpu& gpu) {
  const std::vector<float> weight = halves(size_t{kChannels} * kChannels * 9), bias = halves(kChannels);
  const TensorView input = viewOf(0, kSide, kChannels), output = viewOf(1, kSide, kChannels);
  const Linear linear{.input = input,
                      .output = output,
                      .weight = std::span(weight).first(size_t{kChannels} * kChannels),
                      .bias = bias,
                      .weightType = DataType::f16};
  const Conv3x3 convolution{.input = input,
                            .output = output,
                            .weight = weight,
                            .bias = bias,
                            .inputChannels = kChannels,
                            .outputChannels = kChannels,
                            .weightType = DataType::f16};
  const TensorView tokens = viewOf(0, kLayerSide, kLayerChannels);
  const std::vector<float> table = halves(15 * 15 * kLayerChannels / kHeadChannels);
  const WindowAttention attention{.queries = tokens,
                                  .keys = tokens,
                                  .values = tokens,
                                  .output = viewOf(1, kLayerSide, kLayerChannels),
                                  .biasTable = table,
                                  .headChannels = kHeadChannels,
                                  .shift = 4};
  return isRight(gpu, linear) && isRight(gpu, convolution) && isRight(gpu, attention);
}

bool isFusedLayerRight(Gpu& gpu) {
  constexpr uint32_t c = kLayerChannels, hidden = 2 * c;
  const std::vector<float> numbers = halves(size_t{3} * c * c), table = halves(15 * 15 * c / kHeadChannels);
  const auto map = [&](uint32_t outputs, uint32_t inputs) -> SwinLayer::Map {
    return {std::span(numbers).first(size_t{outputs} * inputs), std::span(numbers).first(outputs)};
  };
  const SwinLayer layer{.input = viewOf(0, kLayerSide, c),
                        .output = viewOf(1, kLayerSide, c),
                        .norm1 = map(c, 1),
                        .norm2 = map(c, 1),
                        .qkv = map(3 * c, c),
                        .proj = map(c, c),
                        .fc1 = map(hidden, c),
                        .fc2 = map(c, hidden),
                        .grow = map(c, c),
                        .biasTable = table,
                        .window = 8,
                        .headChannels = kHeadChannels,
                        .shift = 4};
  return fits(layer, gpu.traits()) && isRight(gpu, layer);
}

// A driver that does not compile the kernels is wrong, too.
bool holds(bool (*areKernelsRight)(Gpu&), Gpu& gpu) {
  try {
    return areKernelsRight(gpu);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

bool proveMatrixKernels(Gpu& gpu) {
  DeviceTraits traits = gpu.traits();
  if (!usesMatrixUnits(traits.family)) return true;
  if (!holds(areRight, gpu)) {
    traits.family = KernelFamily::tile;
    traits.matrixUnits = MatrixUnits::none;
  } else if (traits.family == KernelFamily::fused && !holds(isFusedLayerRight, gpu)) {
    traits.family = KernelFamily::matrix;
  } else {
    return true;
  }
  gpu.setTraits(traits);
  return false;
}

void proveAskedKernels(Gpu& gpu, const std::string& asked) {
  proveMatrixKernels(gpu);
  const KernelFamily family = gpu.traits().family;
  if (asked.empty() || family == kernelFamilyOf(asked)) return;
  throw Error("The " + asked + " kernels do not run or give wrong results on " + gpu.description().name + "; choose " +
              (family == KernelFamily::matrix ? "matrix, plain or tile" : "plain or tile") + ".");
}

}  // namespace xrds
