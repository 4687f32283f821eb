#include "graph/convolution.h"

#include <algorithm>

namespace xrds {
namespace {

constexpr uint32_t kSide = shader::kWinogradSide, kPlanes = shader::kWinogradPlanes;
constexpr uint32_t kMostInputs = 512;                    // whose weights for eight outputs the lane kernel takes
constexpr uint32_t kMostOutputs = 256;                   // whose products are made at once
constexpr uint64_t kBandBytes = uint64_t{12} << 20;      // of planes and products, which caches hold
constexpr uint64_t kGroupSquares = 512;                  // of a workgroup of the products, which share its weights
constexpr uint64_t kWideBandBytes = uint64_t{48} << 20;  // of so many squares of many channels
constexpr uint64_t kMostBytes = uint64_t{120} << 20;     // of a row of planes, which must be bound at once
constexpr uint32_t kPadding = 16;  // channels behind the planes: squares must not all begin at the same set of a cache

uint32_t partsOf(const Conv3x3& op) { return op.shuffleOutput ? 4 : 1; }

// Channels of the output whose products are made at once.
uint32_t channelsAtOnce(const Conv3x3& op) {
  const uint32_t channels = op.output.channels;
  uint32_t most = std::max(4U, std::min(channels, kMostOutputs / partsOf(op)) / 4 * 4);
  while (channels % most != 0) most -= 4;
  return most;
}

uint32_t planesOf(uint32_t channels) { return kPlanes * channels + kPadding; }

uint64_t rowByteSize(const Conv3x3& op) {
  const uint64_t squares = op.input.width / kSide;
  return squares * (planesOf(op.input.channels) + planesOf(partsOf(op) * channelsAtOnce(op))) * byteSize(DataType::f32);
}

// Of at most so many rows those whose squares fill whole workgroups best, but no less than half of them.
uint32_t bandRows(uint32_t squaresOfRow, uint64_t most) {
  const auto waste = [&](uint64_t rows) {
    const uint64_t squares = rows * squaresOfRow;
    return static_cast<double>(alignUp(squares, kGroupSquares)) / static_cast<double>(squares);
  };
  uint64_t best = most;
  for (uint64_t rows = most; rows > 0 && 2 * rows >= most; --rows)
    if (waste(rows) < waste(best)) best = rows;
  return static_cast<uint32_t>(best);
}

// The rows of squares [begin, end) of an image of planes, of which they are stored.
TensorView createPlanes(Graph& graph, std::string name, const Conv3x3& op, uint32_t channels, RowRange rows) {
  const TensorShape shape{ceilDivide(op.input.height, kSide), op.input.width / kSide, planesOf(channels)};
  return slice(graph.createRows(std::move(name), DataType::f32, shape, rows), 0, kPlanes * channels);
}

// `op`: with all input channels.
void addBand(Graph& graph, const std::string& name, const Conv3x3& op, const TensorView& input, const SquareEnds& ends,
             RowRange squares, RowRange pixels) {
  const TensorView planes = createPlanes(graph, name + ".planes", op, op.input.channels, squares);
  const uint32_t first = ends.upsampled.channels;
  if (first > 0)
    graph.nodes.push_back({name + ".upsampled", WinogradInput{.input = ends.upsampled,
                                                              .output = slice(planes, 0, kPlanes * first),
                                                              .rows = squares,
                                                              .seenColumns = op.seenColumns,
                                                              .upsampled = true}});
  graph.nodes.push_back(
      {name + ".planes", WinogradInput{.input = input,
                                       .output = slice(planes, kPlanes * first, planes.channels - kPlanes * first),
                                       .rows = squares,
                                       .seenColumns = op.seenColumns}});
  const bool pooled = ends.pooled.exists();
  const TensorView& stored = pooled ? ends.pooled : op.output;
  const uint32_t step = channelsAtOnce(op);
  for (uint32_t channel = 0; channel < op.output.channels; channel += step) {
    const TensorView products = createPlanes(graph, name + ".products", op, partsOf(op) * step, squares);
    WinogradProducts map{.input = planes, .output = products, .weight = op.weight, .rows = squares};
    map.firstInputs = first;
    map.inputChannels = op.inputChannels;
    map.outputChannels = op.outputChannels;
    map.shuffled = op.shuffleOutput;
    WinogradOutput output{.input = products, .output = slice(stored, channel, step), .bias = op.bias};
    if (op.residual.exists()) output.residual = slice(op.residual, channel, step);
    output.activation = op.activation;
    output.shuffleOutput = op.shuffleOutput;
    output.pooled = pooled;
    output.rows = pooled ? RowRange{pixels.begin / 2, pixels.end / 2} : pixels;
    map.firstOutput = output.firstOutput = channel;
    graph.nodes.push_back({name, map});
    graph.nodes.push_back({name + ".pixels", output});
  }
}

}  // namespace

// The transforms take time as the channels are, the products that they save as the product of inputs and outputs.
bool isWorthSquares(const Conv3x3& op) {
  constexpr uint64_t kInputCost = 15, kOutputCost = 12;
  const uint64_t inputs = op.input.channels, outputs = uint64_t{op.output.channels} * partsOf(op);
  return op.inFours && op.weightType == DataType::f32 && !op.unshuffleInput && op.input.width % kSide == 0 &&
         inputs <= kMostInputs && kInputCost * inputs + kOutputCost * outputs <= inputs * outputs &&
         uint64_t{planesOf(op.input.channels)} * byteSize(DataType::f32) * (op.input.width / kSide) <= kMostBytes;
}

void addInSquares(Graph& graph, const std::string& name, const Conv3x3& given, bool atOnce, const SquareEnds& ends) {
  Conv3x3 op = given;
  op.input.channels += ends.upsampled.channels;
  const RowRange rows = resolve(op.rows, op.input.height);
  const uint32_t begin = rows.begin / kSide, end = ceilDivide(rows.end, kSide);
  const uint32_t squaresOfRow = op.input.width / kSide;
  const uint64_t group = ceilDivide(kGroupSquares, uint64_t{squaresOfRow});
  const uint64_t fitting =
      std::max({kBandBytes / rowByteSize(op), std::min(group, kWideBandBytes / rowByteSize(op)), uint64_t{1}});
  const uint32_t step = atOnce ? end - begin : bandRows(squaresOfRow, std::min<uint64_t>(fitting, end - begin));
  for (uint32_t row = begin; row < end; row += step) {
    const RowRange squares{row, std::min(row + step, end)};
    addBand(graph, name, op, given.input, ends, squares,
            {kSide * squares.begin, std::min(kSide * squares.end, rows.end)});
  }
}

}  // namespace xrds
