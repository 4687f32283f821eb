#pragma once

#include <string_view>
#include <vector>

#include "engine/tensor.h"

namespace xrds {

class ExampleMaker;
class Moments;

/// The largest RMS error, relative to double precision, that is allowed where values are stored in fp32 and in fp16.
struct ErrorBudget {
  double fp32 = 0, fp16 = 0;
};

/// Of what is rounded to 11 bits in fp16, which alone is 2.8e-4.
inline constexpr ErrorBudget kRoundedBudget{5e-7, 4e-4};

/// OperatorInput::reach of what reads the whole image: no tile that begins or ends inside is exact.
inline constexpr uint32_t kWholeImage = 65536;

/// A view that an operator reads.
struct OperatorInput {
  TensorView view;     // absent if it does not exist
  uint32_t reach = 0;  // pixels to each side that a result reads, of the coarser of this view and the results
  OperatorInput(const TensorView& read, uint32_t pixels = 0) : view(read), reach(pixels) {}
};

/// Squares of results that depend on the same inputs: attention windows, or pixels that are rounded together.
struct ResultBlocks {
  uint32_t side = 1, shift = 0;  // a block begins at every pixel shift + n side
};

/// What every operator states of itself beside its kernels and its reference.
struct OperatorFacts {
  std::string_view name;  // as in the names of programs
  std::vector<OperatorInput> inputs;
  ErrorBudget budget;                  // of the operator alone, on the inputs that the device gave it
  uint64_t multiplyAdds = 0;           // of linear maps and convolutions
  uint64_t attentionMultiplyAdds = 0;  // of the token pairs in attention
  ResultBlocks blocks{};               // before a pixel shuffle
};

/// Output pixels to a side of one that the operator computes: 2 where a pixel shuffle ends it.
uint32_t shuffleFactor(const auto& op) {
  if constexpr (requires { op.shuffleOutput; }) return op.shuffleOutput ? 2 : 1;
  return 1;
}

/// The rows that the operator computes, before a pixel shuffle, and the pixels in them.
template <class Op>
RowRange computedRows(const Op& op) {
  RowRange rows;
  if constexpr (requires { op.rows; }) rows = op.rows;
  return resolve(rows, op.output.height / shuffleFactor(op));
}
uint64_t computedPixels(const auto& op) {
  const RowRange rows = computedRows(op);
  return uint64_t{rows.end - rows.begin} * op.output.width / shuffleFactor(op);
}

}  // namespace xrds
