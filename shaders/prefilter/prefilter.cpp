#include "shaders/prefilter/prefilter.h"

#include <algorithm>
#include <cmath>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

constexpr int64_t kTaps = shader::kPrefilterTaps;

// The furthest pixel that a result reads of the level's images, to a side.
uint32_t reachOf(uint32_t level) { return level == 0 ? 2 : shader::kPrefilterStep * reachOf(level - 1); }

// Where an image of a level is.
struct Level {
  TensorView colour, auxMean;
};

Level levelOf(const Prefilter& op, uint32_t level) {
  if (level == 0) return {op.colour, op.auxMean};
  const uint32_t first = (level - 1) * (4 + op.auxMean.channels);
  return {slice(op.coarser, first, 4), slice(op.coarser, first + 4, op.auxMean.channels)};
}

void referencePixel(const Prefilter& op, HostMemory& memory, uint32_t y, uint32_t x) {
  const double limit = shader::kLogitMax;
  double colour[3] = {}, albedo[3] = {}, total = 0;
  for (uint32_t k = 0; k < op.levels; ++k) {
    const Level level = levelOf(op, k);
    const int64_t step = reachOf(k) / 2;
    for (int64_t j = 0; j < kTaps; ++j) {
      const int64_t dy = j / 5 - 2, dx = j % 5 - 2;
      const auto ny = static_cast<uint32_t>(std::clamp<int64_t>(y + step * dy, 0, op.output.height - 1));
      const auto nx = static_cast<uint32_t>(std::clamp<int64_t>(x + step * dx, 0, op.output.width - 1));
      const auto own = [&](uint32_t c) { return memory.at(op.auxMean, y, x, c); };
      const auto taps = [&](uint32_t c) { return memory.at(level.auxMean, ny, nx, c); };
      const double logit = memory.at(op.logits, y, x, static_cast<uint32_t>(k * kTaps + j));
      const double weight = std::exp(static_cast<double>(dy * dy + dx * dx) / (-2 * 1.8 * 1.8)) *
                            (likeness(op.albedoOffset, op.normalOffset, own, taps) + 1e-6) *
                            std::exp(std::clamp(logit, -limit, limit));
      for (uint32_t c = 0; c < 3; ++c) {
        colour[c] += weight * std::max(memory.at(level.colour, ny, nx, c), 0.0);
        albedo[c] += weight * taps(static_cast<uint32_t>(op.albedoOffset) + c);
      }
      total += weight;
    }
  }
  const double exposure = memory.at(op.exposure, 0, 0, 0);
  for (uint32_t c = 0; c < 3; ++c)
    memory.at(op.output, y, x, c) =
        transform(op.transfer, exposure * (colour[c] / total) / (albedo[c] / total + shader::kAlbedoEpsilon));
  memory.at(op.output, y, x, 3) = 0;
}

}  // namespace

TensorShape outputShape(const Prefilter& op) {
  checkHolds(op.output, {1, 1, 4});
  XRDS_CHECK_LE(1u, op.levels);
  XRDS_CHECK_LE(op.levels, static_cast<uint32_t>(shader::kPrefilterLevels));
  XRDS_CHECK_LE(0, op.albedoOffset);
  XRDS_CHECK_LE(-1, op.normalOffset);
  const auto holds = [&](const TensorView& view, uint32_t channels) {
    checkHolds(view, {op.output.height, op.output.width, channels});
  };
  holds(op.colour, 4);
  holds(op.auxMean, static_cast<uint32_t>(std::max(op.albedoOffset, op.normalOffset)) + 3);
  holds(op.logits, static_cast<uint32_t>(kTaps) * op.levels);
  if (op.levels > 1) holds(op.coarser, (op.levels - 1) * (4 + op.auxMean.channels));
  checkView(op.exposure, {1, 1, 4});
  return {op.output.height, op.output.width, 4};
}

Dispatch dispatch(const Prefilter& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const TensorView& coarser = op.levels > 1 ? op.coarser : op.colour;  // an unread binding must still name something
  const shader::PrefilterParams params{.colour = imageOf(op.colour),
                                       .auxMean = imageOf(op.auxMean),
                                       .coarser = imageOf(coarser),
                                       .logits = imageOf(op.logits),
                                       .target = imageOf(op.output),
                                       .rows = targetRows(op.output, rows),
                                       .exposure = imageOf(op.exposure).offset};
  return imageDispatch("prefilter", device, op.output, rows, 1, params,
                       {op.levels, op.auxMean.channels / 4, static_cast<uint32_t>(op.albedoOffset),
                        static_cast<uint32_t>(op.normalOffset), static_cast<uint32_t>(op.transfer)},
                       {readTexels(op.colour), readTexels(op.auxMean), readTexels(coarser), readTexels(op.logits),
                        readTexels(op.exposure), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const Prefilter&, const DeviceTraits&) { return {}; }

void reference(const Prefilter& op, HostMemory& memory) {
  outputShape(op);
  const RowRange rows = resolve(op.rows, op.output.height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < op.output.width; ++x) referencePixel(op, memory, y, x);
}

OperatorFacts facts(const Prefilter& op) {
  const uint32_t furthest = reachOf(op.levels - 1);
  return {"prefilter", {{op.colour, 2}, {op.auxMean, 2}, {op.coarser, furthest}, op.logits, op.exposure}, {1e-6, 1e-6}};
}

void propagate(const Prefilter& op, Moments& moments) {
  for (uint32_t c = 0; c < 3; ++c) moments.at(op.output, c) = {1, 2};  // of T of radiances around mid-grey
}

void addExamples(ExampleMaker& maker, std::vector<Prefilter>& examples) {
  for (const uint32_t levels : {1u, 3u})
    examples.push_back({.colour = maker.view({12, 13, 4}, DataType::f32),
                        .auxMean = maker.view({16, 16, 8}, DataType::f32),
                        .coarser = levels > 1 ? maker.view({12, 13, (levels - 1) * 12}, DataType::f32) : TensorView{},
                        .logits = maker.view({16, 16, alignUp(25 * levels, 4u)}),
                        .exposure = maker.exposure(),
                        .output = maker.view({12, 13, 4}, DataType::f32),
                        .levels = levels,
                        .albedoOffset = 0,
                        .normalOffset = 3,
                        .transfer = Transfer::log1p});
}

}  // namespace xrds
