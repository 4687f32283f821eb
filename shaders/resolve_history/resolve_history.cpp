#include "shaders/resolve_history/resolve_history.h"

#include <algorithm>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

void referencePixel(const ResolveHistory& op, HostMemory& memory, uint32_t y, uint32_t x) {
  const auto sum = [&](uint32_t c) { return memory.at(op.sums, y, x, c); };
  const double least = shader::kHistoryLeast, weights = std::max(sum(11), least);
  const bool guided = op.guides.exists();
  for (uint32_t c = 0; c < 3; ++c) {
    const double albedo = guided ? memory.at(op.guides, y, x, c) : sum(4 + c) / weights;
    memory.at(op.output, y, x, c) = sum(c) / std::max(sum(3), least) * (std::max(albedo, 0.0) + shader::kAlbedoEpsilon);
    if (guided) continue;
    memory.at(op.output, y, x, 4 + c) = albedo;
    memory.at(op.output, y, x, 8 + c) = sum(8 + c) / weights;
  }
  memory.at(op.output, y, x, 3) = sum(3);
  if (guided) return;
  memory.at(op.output, y, x, 7) = sum(7) / weights;
  memory.at(op.output, y, x, 11) = 0;
}

}  // namespace

TensorShape outputShape(const ResolveHistory& op) {
  const uint32_t height = op.sums.height, width = op.sums.width;
  checkView(op.sums, {height, width, shader::kHistoryFrame});
  if (!op.guides.exists()) return op.sums.shape();
  checkView(op.guides, {height, width, op.guides.channels});
  return {height, width, 4};
}

Dispatch dispatch(const ResolveHistory& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const bool guided = op.guides.exists();
  const TensorView& guides = guided ? op.guides : op.sums;  // something must be bound
  const shader::ResolveHistoryParams params{imageOf(op.sums), imageOf(guides), imageOf(op.output),
                                            targetRows(op.output, rows)};
  return imageDispatch("resolve_history", device, op.output, rows, 1, params, {guided},
                       {readTexels(op.sums), readTexels(guides), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const ResolveHistory&, const DeviceTraits&) { return {}; }

void reference(const ResolveHistory& op, HostMemory& memory) {
  outputShape(op);
  const RowRange rows = resolve(op.rows, op.output.height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < op.output.width; ++x) referencePixel(op, memory, y, x);
}

OperatorFacts facts(const ResolveHistory& op) { return {"resolve_history", {op.sums, op.guides}, {2e-6, 1e-3}}; }

void propagate(const ResolveHistory&, Moments&) {}

void addExamples(ExampleMaker& maker, std::vector<ResolveHistory>& examples) {
  for (const bool isGuided : {true, false})
    examples.push_back({.sums = maker.view({16, 16, shader::kHistoryFrame}, DataType::f32),
                        .guides = isGuided ? maker.view({16, 16, 4}, DataType::f32) : TensorView{},
                        .output = maker.view({16, 16, isGuided ? 4U : shader::kHistoryFrame}, DataType::f32)});
}

}  // namespace xrds
