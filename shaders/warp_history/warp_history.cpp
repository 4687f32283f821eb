#include "shaders/warp_history/warp_history.h"

#include <algorithm>
#include <cmath>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

/// A frame's pixel, its radiance without the albedo.
struct Sample {
  double channels[shader::kHistoryFrame] = {};

  void add(const HostMemory& memory, const TensorView& frame, uint32_t y, uint32_t x, double weight) {
    for (uint32_t c = 0; c < shader::kHistoryFrame; ++c) {
      const double divisor = c < 3 ? std::max(memory.at(frame, y, x, 4 + c), 0.0) + shader::kAlbedoEpsilon : 1;
      channels[c] += weight * (memory.at(frame, y, x, c) / divisor);
    }
  }
};

Sample bilinear(const HostMemory& memory, const TensorView& frame, double x, double y) {
  const double lastX = frame.width - 1.0, lastY = frame.height - 1.0;
  x = std::clamp(x, 0.0, lastX);
  y = std::clamp(y, 0.0, lastY);
  const double left = std::floor(x), top = std::floor(y);
  Sample sample;
  for (int i = 0; i < 4; ++i) {
    const int dx = i % 2, dy = i / 2;
    const double weight = (dx ? x - left : 1 - (x - left)) * (dy ? y - top : 1 - (y - top));
    sample.add(memory, frame, static_cast<uint32_t>(std::min(top + dy, lastY)),
               static_cast<uint32_t>(std::min(left + dx, lastX)), weight);
  }
  return sample;
}

void referencePixel(const WarpHistory& op, HostMemory& memory, uint32_t y, uint32_t x) {
  const double exposure = memory.at(op.exposure, 0, 0, 0);
  const auto toned = [&](double light) { return 1 - 1 / (1 + exposure * std::max(light, 0.0)); };
  const auto along = [&](uint32_t c) { return (memory.at(op.positions, y, x, c) + 0.5) / op.scale - 0.5; };
  const Sample history = bilinear(memory, op.history, along(0), along(1));
  Sample present;
  present.add(memory, op.present, y, x, 1);
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
