#include "shaders/fold/fold.h"

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

constexpr uint32_t kSide = shader::kFoldSide, kPatch = kSide * kSide;

uint32_t foldedChannels(const Fold& op) { return op.input.channels / kPatch; }

}  // namespace

TensorShape outputShape(const Fold& op) {
  checkView(op.input, op.input.shape());
  XRDS_CHECK_LT(0u, op.input.channels);
  XRDS_CHECK_EQ(op.input.channels % kPatch, 0u);
  return {2 * op.input.height, 2 * op.input.width, alignUp(foldedChannels(op), 4)};
}

Dispatch dispatch(const Fold& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::FoldParams params{imageOf(op.input), imageOf(op.output), targetRows(op.output, rows)};
  return imageDispatch("fold", device, op.output, rows, 1, params, {foldedChannels(op)},
                       {readTexels(op.input), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const Fold&, const DeviceTraits&) { return {}; }

void reference(const Fold& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t n = 0; n < channels; ++n) {
        double sum = 0;
        for (uint32_t i = 0; i < kSide && n < foldedChannels(op); ++i)
          for (uint32_t j = 0; j < kSide; ++j) {
            const int64_t v = int64_t{y} + 1 - i, u = int64_t{x} + 1 - j;  // twice the patch's pixel
            if (v % 2 != 0 || u % 2 != 0 || v < 0 || u < 0 || v >= height || u >= width) continue;
            sum += memory.at(op.input, static_cast<uint32_t>(v / 2), static_cast<uint32_t>(u / 2),
                             kPatch * n + kSide * i + j);
          }
        memory.at(op.output, y, x, n) = sum;
      }
}

OperatorFacts facts(const Fold& op) { return {"fold", {{op.input, 1}}, kRoundedBudget}; }

void propagate(const Fold& op, Moments& moments) {
  constexpr uint32_t kPatches = 4;  // that a pixel is in, with four of their 16 elements
  for (uint32_t n = 0; n < foldedChannels(op); ++n) {
    Moment sum;
    for (uint32_t i = 0; i < kPatch; ++i) sum = sum + moments.at(op.input, n * kPatch + i);
    moments.at(op.output, n) = {sum.mean / kPatches, sum.variance / kPatches};
  }
}

void addExamples(ExampleMaker& maker, std::vector<Fold>& examples) {
  examples.push_back({.input = maker.view({8, 8, 4 * kPatch}), .output = maker.view({16, 16, 4})});
}

}  // namespace xrds
