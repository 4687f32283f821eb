#include "graph/in_place.h"

#include <algorithm>
#include <numeric>

namespace xrds {
namespace {

// Whether the views put the same element at the same byte of values of the same size.
bool sameBytes(const TensorView& a, const TensorView& b) {
  return a.type == b.type && a.shape() == b.shape() && a.channelOffset == b.channelOffset &&
         a.channelStride == b.channelStride && a.firstRow == b.firstRow && a.storedRows() == b.storedRows();
}

// The residual of the node, if operators of its kind have one, and its output.
struct ResidualSum {
  TensorView residual, output;
};
ResidualSum residualSum(const Node& node) {
  return std::visit(
      [](const auto& op) -> ResidualSum {
        if constexpr (requires { op.residual; }) return {op.residual, op.output};
        return {};
      },
      node.op);
}

/// Rows of a value that a node reads or writes, all channels of them.
struct RowUse {
  uint32_t node = 0;
  uint64_t begin = 0, end = 0;  // of the stored tensor
  bool isResidual = false;      // each element is read before the node writes the same one of its output
  bool overlaps(const RowUse& other) const { return begin < other.end && other.begin < end; }
};

/// What the nodes do with one value.
struct ValueUses {
  std::vector<RowUse> reads, writes;  // in the order of the nodes
  uint64_t rowByteSize = 0;
};

// The rows of a view that are stored.
RowUse rowsRead(uint32_t node, const TensorView& view) {
  const int64_t first = -int64_t{view.firstRow}, end = first + view.height;
  return {node, static_cast<uint64_t>(std::max<int64_t>(first, 0)),
          std::min(static_cast<uint64_t>(end), uint64_t{view.storedRows()})};
}

std::vector<ValueUses> usesOf(const Graph& graph) {
  std::vector<ValueUses> uses(graph.values.size());
  for (uint32_t n = 0; n < graph.nodes.size(); ++n) {
    const TensorView output = outputOf(graph.nodes[n]), residual = residualSum(graph.nodes[n]).residual;
    const RowRange rows = outputRows(graph.nodes[n]);
    const RowUse write{n, output.storedRow(rows.begin), output.storedRow(rows.end)};
    uses[output.value].writes.push_back(write);
    uses[output.value].rowByteSize = output.rowByteSize();
    const std::vector<OperatorInput> inputs = factsOf(graph.nodes[n]).inputs;
    const auto ofResidual = [&](const OperatorInput& input) { return input.view.value == residual.value; };
    const bool isApart = std::count_if(inputs.begin(), inputs.end(), ofResidual) == 1 && sameBytes(residual, output);
    for (const OperatorInput& input : inputs)
      if (input.view.exists())
        uses[input.view.value].reads.push_back(isApart && ofResidual(input) ? RowUse{n, write.begin, write.end, true}
                                                                            : rowsRead(n, input.view));
  }
  return uses;
}

// The residual that node n is the last to read, as nothing but the residual, and that its output, of which it makes the
// first rows, begins with; else kNoValue.
ValueId residualToContinue(const Graph& graph, const std::vector<ValueUses>& uses, uint32_t n) {
  const auto [residual, output] = residualSum(graph.nodes[n]);
  if (!residual.exists() || !sameBytes(residual, output) || residual.value == output.value) return kNoValue;
  const auto& [reads, writes, rowByteSize] = uses[residual.value];
  if (reads.back().node != n || (!writes.empty() && writes.back().node > n)) return kNoValue;
  // As the convolution's input, say, it would be read after neighbours have become sums.
  const auto readsHere = std::count_if(reads.begin(), reads.end(), [&](const RowUse& use) { return use.node == n; });
  return readsHere == 1 ? residual.value : kNoValue;
}

// Whether `made` may be written over `read`: that is whole before, and none of its rows is read by the node that
// overwrites it, or later. A node may overwrite what it reads as its residual alone.
bool mayOverwrite(const ValueUses& made, const ValueUses& read) {
  if (read.writes.empty() || read.reads.empty() || read.rowByteSize != made.rowByteSize) return false;
  const uint32_t firstMade = made.writes.front().node;
  if (read.writes.back().node >= firstMade || read.reads.back().node <= firstMade) return false;
  return std::all_of(made.writes.begin(), made.writes.end(), [&](const RowUse& write) {
    return std::none_of(read.reads.begin(), read.reads.end(), [&](const RowUse& use) {
      return use.node + (use.isResidual ? 0U : 1U) > write.node && use.overlaps(write);
    });
  });
}

}  // namespace

std::vector<ValueId> inPlaceStorage(const Graph& graph) {
  std::vector<ValueId> storage(graph.values.size());
  std::iota(storage.begin(), storage.end(), ValueId{0});
  std::vector<bool> isContinued(graph.values.size());
  const std::vector<ValueUses> uses = usesOf(graph);
  for (uint32_t n = 0; n < graph.nodes.size(); ++n) {
    const ValueId made = outputOf(graph.nodes[n]).value;
    if (uses[made].writes.front().node != n) continue;
    ValueId earlier = residualToContinue(graph, uses, n);
    for (ValueId read = 0; earlier == kNoValue && read < graph.values.size(); ++read)
      if (!isContinued[read] && graph.values[read].byteSize() == graph.values[made].byteSize() &&
          mayOverwrite(uses[made], uses[read]))
        earlier = read;
    if (earlier == kNoValue || isContinued[earlier]) continue;
    storage[made] = storage[earlier];
    isContinued[earlier] = true;
  }
  return storage;
}

}  // namespace xrds
