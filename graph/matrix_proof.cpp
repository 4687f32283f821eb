#include "graph/matrix_proof.h"

#include <random>

#include "graph/placed_operator.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint32_t kSide = 20, kChannels = 48;  // several workgroups, and fragments that are not full

std::vector<float> halves(size_t count) {
  std::minstd_rand random(1);
  std::vector<float> numbers(count);
  for (float& number : numbers) number = static_cast<float>(static_cast<int>(random() % 513) - 256) / 256;
  return numbers;
}

bool isRight(Gpu& gpu, Operator op) {
  Graph graph;
  graph.nodes.push_back({"matrix_proof", std::move(op)});
  for (const char* name : {"input", "output"}) graph.create(name, DataType::f16, {kSide, kSide, kChannels});
  const PlacedOperator placed(gpu, graph);
  Recording(gpu, placed.dispatches()).run();
  return placed.error().withinTolerance;
}

bool areRight(Gpu& gpu) {
  const std::vector<float> weight = halves(size_t{kChannels} * kChannels * 9), bias = halves(kChannels);
  const TensorView input{0, DataType::f16, kSide, kSide, kChannels, 0, kChannels};
  TensorView output = input;
  output.value = 1;
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
  return isRight(gpu, linear) && isRight(gpu, convolution);
}

}  // namespace

bool proveMatrixKernels(Gpu& gpu) {
  if (gpu.traits().family != KernelFamily::matrix) return true;
  try {
    if (areRight(gpu)) return true;
  } catch (const Error&) {  // a driver that does not compile them is wrong, too
  }
  DeviceTraits traits = gpu.traits();
  traits.family = KernelFamily::tile;
  traits.matrixUnits = MatrixUnits::none;
  gpu.setTraits(traits);
  return false;
}

}  // namespace xrds
