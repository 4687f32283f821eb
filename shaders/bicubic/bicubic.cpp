#include "shaders/bicubic/bicubic.h"

#include <algorithm>
#include <cmath>

#include "shaders/common/cubic.h"
#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

double cubic(double t) { return cubicWeight(t, shader::kBicubicParameter); }

}  // namespace

TensorShape outputShape(const Bicubic& op) {
  checkHolds(op.output, {1, 1, 4});
  checkScale(op.scale);
  XRDS_CHECK_EQ(op.output.height % op.scale, 0u);
  XRDS_CHECK_EQ(op.output.width % op.scale, 0u);
  checkHolds(op.input, {op.output.height / op.scale, op.output.width / op.scale, 4});
  XRDS_CHECK_EQ(op.input.channels, 4u);
  return {op.output.height, op.output.width, 4};
}

Dispatch dispatch(const Bicubic& op, const DeviceTraits&) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  // Rows between two centres of the input share their four input rows: an invocation takes a run of them.
  const int run = static_cast<int>(std::min(op.scale, 4u));
  const int shift = static_cast<int>(op.scale / 2) % run;
  const int firstRow = (static_cast<int>(rows.begin) + shift) / run * run - shift;
  const shader::BicubicParams params{imageOf(op.input), imageOf(op.output), targetRows(op.output, rows), firstRow};
  return {.program = programName("bicubic", KernelFamily::plain, op.output.type),
          .specialization = {op.scale, static_cast<uint32_t>(run)},
          .bindings = {readTexels(op.input), writeRows(op.output, rows)},
          .pushConstants = pushBytes(params),
          .groupCount = imageGroups(op.output.width, ceilDivide(static_cast<int>(rows.end) - firstRow, run))};
}

std::vector<float> packedWeights(const Bicubic&, const DeviceTraits&) { return {}; }

void reference(const Bicubic& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  const double s = op.scale;
  const int h = static_cast<int>(height / op.scale), w = static_cast<int>(width / op.scale);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) {
        const double v = (y + 0.5) / s - 0.5, u = (x + 0.5) / s - 0.5;
        const int top = static_cast<int>(std::floor(v)) - 1, left = static_cast<int>(std::floor(u)) - 1;
        double sum = 0;
        for (int i = top; i < top + 4; ++i)
          for (int j = left; j < left + 4; ++j)
            sum +=
                cubic(v - i) * cubic(u - j) * memory.at(op.input, std::clamp(i, 0, h - 1), std::clamp(j, 0, w - 1), c);
        memory.at(op.output, y, x, c) = sum;
      }
}

OperatorFacts facts(const Bicubic& op) { return {"bicubic", {{op.input, 2}}, {1e-6, 1e-6}}; }

// Stored in fp32 always.
void propagate(const Bicubic&, Moments&) {}

void addExamples(ExampleMaker& maker, std::vector<Bicubic>& examples) {
  examples.push_back(
      {.input = maker.view({8, 8, 4}, DataType::f32), .output = maker.view({16, 16, 4}, DataType::f32), .scale = 2});
}

}  // namespace xrds
