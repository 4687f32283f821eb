#include "graph/reach.h"

#include <algorithm>

namespace xrds {
namespace {

// The pixels of an input that differ from the whole frame's, seen by results of that height.
uint32_t seenBy(uint32_t height, const OperatorInput& input, uint32_t inexact) {
  if (input.view.height < height) return (inexact + input.reach) * (height / input.view.height);
  return ceilDivide(inexact, input.view.height / height) + input.reach;
}

// A block is exact if all that it depends on is.
uint32_t wholeBlocks(uint32_t inexact, ResultBlocks blocks) {
  return inexact <= blocks.shift ? blocks.shift : alignUp(inexact - blocks.shift, blocks.side) + blocks.shift;
}

}  // namespace

std::vector<uint32_t> firstExactPixels(const Graph& graph) {
  std::vector<uint32_t> first(graph.values.size());
  for (const Node& node : graph.nodes) {
    const OperatorFacts facts = factsOf(node);
    const TensorView output = outputOf(node);
    const uint32_t shuffle = std::visit([](const auto& op) { return shuffleFactor(op); }, node.op);
    uint32_t inexact = 0;
    for (const OperatorInput& input : facts.inputs)
      if (input.view.exists())
        inexact = std::max(inexact, seenBy(output.height / shuffle, input, first[input.view.value]));
    uint32_t& known = first[output.value];
    known = std::max(known, std::min(shuffle * wholeBlocks(inexact, facts.blocks), kWholeImage));
  }
  return first;
}

}  // namespace xrds
