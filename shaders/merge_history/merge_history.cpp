#include "shaders/merge_history/merge_history.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

/// Sums of channels of what was warped over the pixels around one, the image's border continued.
struct Around {
  std::array<double, shader::kHistoryWarped> mean{}, square{};

  Around(const TensorView& warped, const HostMemory& memory, int64_t y, int64_t x, int64_t radius) {
    const auto side = static_cast<double>(2 * radius + 1);
    for (int64_t dy = -radius; dy <= radius; ++dy)
      for (int64_t dx = -radius; dx <= radius; ++dx) {
        const auto ny = static_cast<uint32_t>(std::clamp<int64_t>(y + dy, 0, warped.height - 1));
        const auto nx = static_cast<uint32_t>(std::clamp<int64_t>(x + dx, 0, warped.width - 1));
        for (uint32_t c = 0; c < mean.size(); ++c) {
          const double value = memory.at(warped, ny, nx, c);
          mean[c] += value / (side * side);
          square[c] += value * value / (side * side);
        }
      }
  }
  double variance(uint32_t c) const { return std::max(square[c] - mean[c] * mean[c], 0.0); }
};

double square(double value) { return value * value; }

void referencePixel(const MergeHistory& op, HostMemory& memory, uint32_t y, uint32_t x) {
  const auto warped = [&](uint32_t c) { return memory.at(op.warped, y, x, c); };
  const auto present = [&](uint32_t c) { return memory.at(op.present, y, x, c); };
  const Around wide(op.warped, memory, y, x, op.radius), close(op.warped, memory, y, x, 1);
  const double samples = square(2.0 * op.radius + 1), count = warped(3);
  const double luck =
      std::clamp(count / std::max(present(3), double{shader::kHistoryLeast}), 1.0, double{shader::kHistoryLuck});
  double part = square(close.mean[7] / shader::kHistoryNearness), noise = 0, bias = 0;
  for (uint32_t c = 0; c < 3; ++c) {
    part += square(close.mean[8 + c] / shader::kHistoryAlbedo) + square(close.mean[12 + c] / shader::kHistoryNormal);
    noise += wide.variance(4 + c);
    bias += std::max(square(wide.mean[4 + c]) - luck * wide.variance(4 + c) / samples, 0.0);
  }
  const double both = std::max(count + present(3), double{shader::kHistoryLeast});
  noise = noise * count * present(3) / both + shader::kHistoryNoise;
  const double guideWeight = count * std::exp(-std::min(part, 80.0));
  const double ratio = shader::kHistoryBias * count * bias / noise;
  const double weight = guideWeight / (1 + ratio + square(ratio));

  std::array<double, shader::kHistoryFrame> first{}, further{};
  for (uint32_t c = 0; c < 3; ++c) {
    first[c] = present(3) * (present(c) / (std::max(present(4 + c), 0.0) + shader::kAlbedoEpsilon));
    further[c] = weight * warped(c);
    for (const uint32_t guide : {4U, 8U}) {
      first[guide + c] = present(3) * present(guide + c);
      further[guide + c] = guideWeight * (present(guide + c) + warped(guide + 4 + c));
    }
  }
  first[3] = first[11] = present(3);
  further[3] = weight;
  further[11] = guideWeight;
  first[7] = present(3) * present(7);
  further[7] = guideWeight * present(7);
  for (uint32_t c = 0; c < first.size(); ++c)
    memory.at(op.output, y, x, c) = (op.sums.exists() ? memory.at(op.sums, y, x, c) : first[c]) + further[c];
}

}  // namespace

TensorShape outputShape(const MergeHistory& op) {
  const TensorShape shape{op.present.height, op.present.width, shader::kHistoryFrame};
  checkView(op.present, shape);
  checkView(op.warped, {shape.height, shape.width, shader::kHistoryWarped});
  if (op.sums.exists()) checkView(op.sums, shape);
  XRDS_CHECK_LE(1u, op.radius);
  return shape;
}

Dispatch dispatch(const MergeHistory& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const bool first = !op.sums.exists();
  const TensorView& sums = first ? op.present : op.sums;  // something must be bound
  const shader::MergeHistoryParams params{imageOf(op.warped), imageOf(op.present), imageOf(sums), imageOf(op.output),
                                          targetRows(op.output, rows)};
  return imageDispatch("merge_history", device, op.output, rows, 1, params, {op.radius, first},
                       {readTexels(op.warped), readTexels(op.present), readTexels(sums), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const MergeHistory&, const DeviceTraits&) { return {}; }

void reference(const MergeHistory& op, HostMemory& memory) {
  outputShape(op);
  const RowRange rows = resolve(op.rows, op.output.height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < op.output.width; ++x) referencePixel(op, memory, y, x);
}

OperatorFacts facts(const MergeHistory& op) {
  return {"merge_history", {{op.warped, op.radius}, op.present, op.sums}, {5e-6, 1e-3}};
}

void propagate(const MergeHistory&, Moments&) {}

// Differences that leave a weight of about a third.
void addExamples(ExampleMaker& maker, std::vector<MergeHistory>& examples) {
  for (const bool isFirst : {true, false}) {
    const auto frame = [&] { return maker.view({16, 16, shader::kHistoryFrame}, DataType::f32); };
    examples.push_back({.warped = maker.view({16, 16, shader::kHistoryWarped}, DataType::f32, {0.02F, 0.12F}),
                        .present = frame(),
                        .sums = isFirst ? TensorView{} : frame(),
                        .output = frame()});
  }
}

}  // namespace xrds
