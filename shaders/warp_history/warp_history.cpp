#include "shaders/warp_history/warp_history.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "shaders/common/cubic.h"
#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

constexpr uint32_t kLight = 4;  // channels of light and count, before those of the guides

/// A frame's pixel, its radiance without the albedo.
struct Sample {
  double channels[shader::kHistoryFrame] = {};
};

Sample pixelOf(const HostMemory& memory, const TensorView& frame, double x, double y) {
  const auto column = static_cast<uint32_t>(std::clamp(x, 0.0, frame.width - 1.0));
  const auto row = static_cast<uint32_t>(std::clamp(y, 0.0, frame.height - 1.0));
  Sample sample;
  for (uint32_t c = 0; c < shader::kHistoryFrame; ++c) {
    const double divisor =
        c < 3 ? std::max(memory.at(frame, row, column, kLight + c), 0.0) + shader::kAlbedoEpsilon : 1;
    sample.channels[c] = memory.at(frame, row, column, c) / divisor;
  }
  return sample;
}

// Cubic, and within the four nearest.
Sample interpolated(const HostMemory& memory, const TensorView& frame, double x, double y) {
  x = std::clamp(x, 0.0, frame.width - 1.0);
  y = std::clamp(y, 0.0, frame.height - 1.0);
  Sample sum, lowest, highest;
  std::fill(std::begin(lowest.channels), std::end(lowest.channels), std::numeric_limits<double>::infinity());
  std::fill(std::begin(highest.channels), std::end(highest.channels), -std::numeric_limits<double>::infinity());
  for (int dy = -1; dy <= 2; ++dy)
    for (int dx = -1; dx <= 2; ++dx) {
      const double column = std::floor(x) + dx, row = std::floor(y) + dy;
      const double far = std::abs(x - column), down = std::abs(y - row);
      const Sample pixel = pixelOf(memory, frame, column, row);
      for (uint32_t c = 0; c < shader::kHistoryFrame; ++c) {
        sum.channels[c] +=
            cubicWeight(far, shader::kHistoryCubic) * cubicWeight(down, shader::kHistoryCubic) * pixel.channels[c];
        if (std::min(dx, dy) < 0 || std::max(dx, dy) > 1) continue;
        lowest.channels[c] = std::min(lowest.channels[c], pixel.channels[c]);
        highest.channels[c] = std::max(highest.channels[c], pixel.channels[c]);
      }
    }
  for (uint32_t c = 0; c < shader::kHistoryFrame; ++c)
    sum.channels[c] = std::clamp(sum.channels[c], lowest.channels[c], highest.channels[c]);
  return sum;
}

void referencePixel(const WarpHistory& op, HostMemory& memory, uint32_t y, uint32_t x) {
  const double exposure = memory.at(op.exposure, 0, 0, 0);
  const auto toned = [&](double light) { return 1 - 1 / (1 + exposure * std::max(light, 0.0)); };
  const auto along = [&](uint32_t c) { return (memory.at(op.positions, y, x, c) + 0.5) / op.scale - 0.5; };
  const Sample history = interpolated(memory, op.history, along(0), along(1)),
               present = pixelOf(memory, op.present, x, y);
  const auto& [h] = history;
  const auto& [p] = present;
  const double nearness = std::max({h[7], p[7], double{shader::kHistoryNearest}});
  const double values[shader::kHistoryWarped] = {h[0],
                                                 h[1],
                                                 h[2],
                                                 h[3] * memory.at(op.positions, y, x, 2),
                                                 toned(h[0]) - toned(p[0]),
                                                 toned(h[1]) - toned(p[1]),
                                                 toned(h[2]) - toned(p[2]),
                                                 (h[7] - p[7]) / nearness,
                                                 h[4] - p[4],
                                                 h[5] - p[5],
                                                 h[6] - p[6],
                                                 0,
                                                 h[8] - p[8],
                                                 h[9] - p[9],
                                                 h[10] - p[10],
                                                 0};
  for (uint32_t c = 0; c < shader::kHistoryWarped; ++c) memory.at(op.output, y, x, c) = values[c];
}

}  // namespace

TensorShape outputShape(const WarpHistory& op) {
  const uint32_t height = op.present.height, width = op.present.width;
  checkView(op.present, {height, width, shader::kHistoryFrame});
  checkView(op.history, {height, width, shader::kHistoryFrame});
  checkView(op.positions, {height, width, 4});
  checkView(op.exposure, {1, 1, 4});
  checkScale(op.scale);
  return {height, width, shader::kHistoryWarped};
}

Dispatch dispatch(const WarpHistory& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::WarpHistoryParams params{imageOf(op.positions),       imageOf(op.history),
                                         imageOf(op.present),         imageOf(op.output),
                                         targetRows(op.output, rows), imageOf(op.exposure).offset};
  return imageDispatch("warp_history", device, op.output, rows, 1, params, {op.scale},
                       {readTexels(op.positions), readTexels(op.history), readTexels(op.present),
                        readTexels(op.exposure), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const WarpHistory&, const DeviceTraits&) { return {}; }

void reference(const WarpHistory& op, HostMemory& memory) {
  outputShape(op);
  const RowRange rows = resolve(op.rows, op.output.height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < op.output.width; ++x) referencePixel(op, memory, y, x);
}

OperatorFacts facts(const WarpHistory& op) {
  return {"warp_history",
          {op.positions, {op.history, std::max(op.history.width, op.history.height)}, op.present, op.exposure},
          {2e-6, 1e-3}};
}

void propagate(const WarpHistory&, Moments&) {}

// Positions inside and outside of the image.
void addExamples(ExampleMaker& maker, std::vector<WarpHistory>& examples) {
  examples.push_back({.positions = maker.view({16, 16, 4}, DataType::f32, {-2, 18}),
                      .history = maker.view({16, 16, shader::kHistoryFrame}, DataType::f32),
                      .present = maker.view({16, 16, shader::kHistoryFrame}, DataType::f32),
                      .exposure = maker.exposure(),
                      .output = maker.view({16, 16, shader::kHistoryWarped}, DataType::f32)});
}

}  // namespace xrds
