#include "shaders/filter_auxiliary/filter_auxiliary.h"

#include <algorithm>
#include <cmath>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

// How many pixels of a column share the loads of their neighbours. On lavapipe m = 5 takes a fifth less time than with
// runs of one pixel, m = 3 as much.
constexpr uint32_t kRun = 4;

void referencePixel(const FilterAuxiliary& op, HostMemory& memory, uint32_t y, uint32_t x) {
  const int side = static_cast<int>(op.kernelSide), height = static_cast<int>(op.output.height),
            width = static_cast<int>(op.output.width);
  const double limit = shader::kLogitMax;
  std::vector<double> sums(op.output.channels);
  double total = 0;
  for (int j = 0; j < side * side; ++j) {
    const uint32_t ny = std::clamp(static_cast<int>(y) + j / side - side / 2, 0, height - 1);
    const uint32_t nx = std::clamp(static_cast<int>(x) + j % side - side / 2, 0, width - 1);
    const double weight = std::exp(std::clamp(memory.at(op.network, y, x, op.firstLogit + j), -limit, limit));
    for (uint32_t c = 0; c < op.output.channels; ++c) sums[c] += weight * memory.at(op.aux, ny, nx, c);
    total += weight;
  }
  for (uint32_t c = 0; c < op.output.channels; ++c) memory.at(op.output, y, x, c) = sums[c] / total;
}

}  // namespace

TensorShape outputShape(const FilterAuxiliary& op) {
  checkHolds(op.output, {1, 1, 4});
  XRDS_CHECK_EQ(op.kernelSide % 2, 1u);
  const TensorShape shape{op.output.height, op.output.width, op.aux.channels};
  checkHolds(op.aux, shape);
  checkHolds(op.network, {shape.height, shape.width, op.firstLogit + op.kernelSide * op.kernelSide});
  return shape;
}

Dispatch dispatch(const FilterAuxiliary& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::FilterAuxiliaryParams params{imageOf(op.aux), imageOf(op.network), imageOf(op.output),
                                             targetRows(op.output, rows)};
  return imageDispatch("filter_auxiliary", device, op.output, rows, kRun, params,
                       {op.output.channels / 4, op.kernelSide, op.firstLogit, kRun},
                       {readTexels(op.aux), readTexels(op.network), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const FilterAuxiliary&, const DeviceTraits&) { return {}; }

void reference(const FilterAuxiliary& op, HostMemory& memory) {
  outputShape(op);
  const RowRange rows = resolve(op.rows, op.output.height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < op.output.width; ++x) referencePixel(op, memory, y, x);
}

OperatorFacts facts(const FilterAuxiliary& op) {
  return {"filter_auxiliary", {{op.aux, op.kernelSide / 2}, op.network}, kRoundedBudget};
}

void propagate(const FilterAuxiliary& op, Moments& moments) { moments.copy(op.aux, op.output); }

void addExamples(ExampleMaker& maker, std::vector<FilterAuxiliary>& examples) {
  examples.push_back({.aux = maker.view({16, 16, 8}),
                      .network = maker.view({16, 16, 12}),
                      .output = maker.view({16, 16, 8}),
                      .kernelSide = 3,
                      .firstLogit = 3});
}

}  // namespace xrds
