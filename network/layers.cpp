#include "network/layers.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "network/network.h"

namespace xrds {
namespace {

// Of less work than this, the start of a dispatch shows: 16 rows of 256 pixels, 48 rows of 1024.
constexpr uint32_t kLeastBandPixels = 4096, kLeastSweepPixels = 49152;
// Frames of at most this are made in one piece: they need less memory than larger ones do, and nano gains a sixth.
constexpr uint64_t kWholeColourPixels = uint64_t{1} << 14, kWholeOutputPixels = uint64_t{1} << 18;
constexpr uint32_t kBandChannels = 64;  // with which a band of 1 / tensors of the image is as large as caches like
constexpr uint32_t kSweepSteps = 24;    // of an image
constexpr uint32_t kSweepUnit = 16;     // rows: whole pixels of the colour at any scale, whole strips of the kernels
constexpr uint64_t kSweepPixels = 8;    // of the output, for each of GraphOptions::bandPixels: its features are narrow

}  // namespace

TensorView Layers::conv(const std::string& name, TensorView x, uint32_t inputs, uint32_t outputs, ConvOptions options) {
  TensorShape shape{x.height, x.width, ceilDivide(outputs, 4) * 4};
  if (options.unshuffle) shape = {x.height / 2, x.width / 2, shape.channels};
  if (options.shuffle) shape = {2 * shape.height, 2 * shape.width, outputs / 4};
  Conv3x3 op = convolutionOf(name, x, options);
  if (options.ends.pooled.exists())
    op.output = {.height = shape.height, .width = shape.width, .channels = shape.channels};  // is not stored
  else
    op.output = options.into.exists() ? options.into : graph.create(name, stored(name), shape);
  op.weight = weight(name + ".weight", {outputs, inputs, 3, 3});
  op.bias = weight(name + ".bias", {outputs});
  op.inputChannels = inputs;
  op.outputChannels = outputs;
  addConvolution(name, op, options.rowsInFours, options.ends);
  return options.ends.pooled.exists() ? options.ends.pooled : op.output;
}

Conv3x3 Layers::convolutionOf(const std::string& name, const TensorView& x, const ConvOptions& options) const {
  return {.input = x,
          .residual = options.residual,
          .activation = options.activation,
          .unshuffleInput = options.unshuffle,
          .shuffleOutput = options.shuffle,
          .inFours = options.inFours && config.mayRoundInFours(),
          .weightType = storedWeights(name),
          .rows = options.rows,
          .seenColumns = options.seenColumns};
}

bool Layers::takesEnds(const std::string& name, TensorShape x, uint32_t outputs, const ConvOptions& options) const {
  Conv3x3 op = convolutionOf(name, {.height = x.height, .width = x.width, .channels = x.channels}, options);
  op.output.channels = ceilDivide(outputs, 4) * 4;
  return isInSquares(op, options.rowsInFours);
}

bool Layers::isInSquares(const Conv3x3& op, bool rowsInFours) const {
  return graphOptions.inSquares && (rowsInFours || op.rows == RowRange{}) && isWorthSquares(op);
}

void Layers::addConvolution(const std::string& name, const Conv3x3& op, bool rowsInFours, const SquareEnds& ends) {
  Conv3x3 whole = op;
  whole.input.channels += ends.upsampled.channels;
  const bool inSquares = isInSquares(whole, rowsInFours);
  XRDS_CHECK(inSquares || !(ends.upsampled.exists() || ends.pooled.exists()));
  if (inSquares)
    addInSquares(graph, name, op, graphOptions.bandRows == kWholeFrame, ends);
  else
    graph.nodes.push_back({name, op});
}

TensorView Layers::addLinear(const std::string& name, uint32_t outputs, Linear op) {
  op.bias = weight(name + ".bias", {outputs});
  op.weightType = storedWeights(name);
  graph.nodes.push_back({name, op});
  return op.output;
}

TensorView Layers::linear(const std::string& name, TensorView x, uint32_t outputs, TensorView into, TensorView residual,
                          Activation activation) {
  return addLinear(name, outputs,
                   {.input = x,
                    .output = into.exists() ? into : create(name, x, outputs),
                    .residual = residual,
                    .weight = weight(name + ".weight", {outputs, x.channels}),
                    .activation = activation});
}

TensorView Layers::normedLinear(const std::string& norm, const std::string& name, TensorView x, uint32_t outputs,
                                Activation activation) {
  if (!graphOptions.normsInLinear) return linear(name, layerNorm(norm, x), outputs, {}, {}, activation);
  return addLinear(name, outputs,
                   {.input = x,
                    .output = create(name, x, outputs),
                    .weight = weight(name + ".weight", {outputs, x.channels}),
                    .norm = {weight(norm + ".weight", {x.channels}), weight(norm + ".bias", {x.channels})},
                    .activation = activation});
}

// In NHWC a 1x1 convolution is a linear map of each pixel; only the weight's shape in the file differs.
TensorView Layers::conv1x1(const std::string& name, TensorView x, uint32_t outputs, TensorView into,
                           TensorView residual) {
  return addLinear(name, outputs,
                   {.input = x,
                    .output = into.exists() ? into : create(name, x, outputs),
                    .residual = residual,
                    .weight = weight(name + ".weight", {outputs, x.channels, 1, 1})});
}

TensorView Layers::conv1x1Rows(const std::string& name, TensorView x, TensorView appended, uint32_t outputs,
                               TensorView into, RowRange rows) {
  return addLinear(name, outputs,
                   {.input = x,
                    .output = into,
                    .appended = appended,
                    .weight = weight(name + ".weight", {outputs, x.channels + appended.channels, 1, 1}),
                    .rows = rows});
}

TensorView Layers::denseConvolutions(const std::string& name, TensorView dense, TensorView into,
                                     const DenseOptions& options) {
  const uint32_t growth = options.growth ? options.growth : dense.channels / (options.count + 1);
  const uint32_t c = dense.channels - options.count * growth;
  for (uint32_t k = 0; k < options.count; ++k) {
    const uint32_t inputs = c + k * growth;
    conv(name + options.grow + std::to_string(k) + options.grown, slice(dense, 0, inputs), inputs, growth,
         {.into = slice(dense, inputs, growth), .activation = Activation::relu, .inFours = options.inFours});
  }
  return conv1x1(name + options.fuse, dense, c, into, slice(dense, 0, c));
}

ConvWeights Layers::madeOnce(const std::string& name, const std::function<JoinedWeights()>& make) {
  auto made = made_.find(name);
  if (made == made_.end()) {
    JoinedWeights weights = make();
    made = made_.emplace(name, ConvWeights{graph.keep(std::move(weights.weight)), graph.keep(std::move(weights.bias))})
               .first;
  }
  return made->second;
}

Conv3x3 Layers::joinedConvolution(const std::string& doubling, TensorView x, ConvWeights joined) {
  Conv3x3 op{.input = x, .weight = joined.weight, .bias = joined.bias};
  op.inputChannels = x.channels;
  op.outputChannels = static_cast<uint32_t>(joined.bias.size());
  op.inFours = config.mayRoundInFours();
  op.weightType = storedWeights(doubling);
  return op;
}

ConvWeights Layers::doublingWeights(const std::string& doubling, uint32_t inputs, uint32_t channels) {
  return {weight(doubling + ".weight", {4 * channels, inputs, 3, 3}), weight(doubling + ".bias", {4 * channels})};
}

// Nothing stands between the two, and a 1x1 convolution sees no border.
void Layers::outputOfDoubling(const std::string& doubling, const std::string& name, TensorView x, TensorView appended,
                              uint32_t outputs, TensorView into, RowRange rows, bool rowsInFours) {
  const uint32_t c = x.channels, inputs = c + appended.channels;
  const ConvWeights output{weight(name + ".weight", {outputs, inputs, 1, 1}), weight(name + ".bias", {outputs})};
  Conv3x3 op = joinedConvolution(
      doubling, x, madeOnce(doubling, [&] { return joinedWithOutput(doublingWeights(doubling, c, c), output); }));
  op.output = into;
  op.shuffleOutput = true;
  op.rows = {rows.begin / 2, rows.end / 2};
  if (appended.exists()) {
    const ConvWeights rest = madeOnce(name, [&] {
      JoinedWeights made{.bias = std::vector<float>(outputs)};
      for (auto row = output.weight.begin(); row != output.weight.end(); row += inputs)
        made.weight.insert(made.weight.end(), row + c, row + inputs);
      return made;
    });
    Linear linear{.input = appended, .weight = rest.weight, .bias = rest.bias};
    linear.output = graph.createRows(name + ".appended", stored(name), into.shape(), rows);
    linear.weightType = storedWeights(name);
    linear.rows = rows;
    graph.nodes.push_back({name, linear});
    op.residual = linear.output;
  }
  addConvolution(doubling, op, rowsInFours);
}

void Layers::patchesOfDoubling(const std::string& doubling, const std::string& name, TensorView x, uint32_t channels,
                               uint32_t outputs, TensorView into, RowRange rows, bool rowsInFours) {
  const ConvWeights output{weight(name + ".weight", {outputs, channels, 3, 3}), weight(name + ".bias", {outputs})};
  Conv3x3 op = joinedConvolution(doubling, x, madeOnce(doubling, [&] {
                                   return joinedAsPatches(doublingWeights(doubling, x.channels, channels), output);
                                 }));
  op.output = into;
  op.rows = rows;
  addConvolution(doubling, op, rowsInFours);
}

TensorView Layers::conv1x1OfSum(const std::string& first, const std::string& name, TensorView x, TensorView t,
                                uint32_t outputs, TensorView into) {
  static constexpr std::array<float, 512> kZeros{};  // as many as there are channels
  if (!graphOptions.mapsJoined) return conv1x1(name, linear(first, x, t.channels, {}, t), outputs, into);
  Linear op{.input = x,
            .output = create(first, x, outputs),
            .weight = weight(name + ".weight", {outputs, t.channels, 1, 1}),
            .bias = std::span(kZeros).first(outputs),
            .first = {weight(first + ".weight", {t.channels, x.channels}), weight(first + ".bias", {t.channels})}};
  op.weightType = storedWeights(first);
  graph.nodes.push_back({first, op});
  return conv1x1(name, t, outputs, into, op.output);
}

TensorView Layers::layerNorm(const std::string& name, TensorView x) {
  LayerNorm op;
  op.input = x;
  op.output = create(name, x, x.channels);
  op.weight = weight(name + ".weight", {x.channels});
  op.bias = weight(name + ".bias", {x.channels});
  graph.nodes.push_back({name, op});
  return op.output;
}

TensorView Layers::attention(const std::string& name, TensorView q, TensorView k, TensorView v, bool shifted,
                             const WindowBand& band) {
  const uint32_t side = 2 * config.window - 1;
  const TensorView heads = create(name, q, q.channels);
  WindowAttention op{.queries = q, .keys = k, .values = v, .output = heads};
  op.biasTable = weight(name + ".relative_position_bias_table", {side * side, q.channels / config.headChannels});
  op.window = config.window;
  op.headChannels = config.headChannels;
  op.shift = shifted ? config.window / 2 : 0;
  if (shifted && !band.isWhole() && band.endRows == 0) {  // in an image of its own, the shift would wrap its rows
    for (TensorView* view : {&op.queries, &op.keys, &op.values, &op.output})
      *view = asRowsOf(*view, band.height, band.rows.begin);
    op.rows = band.rows;
  }
  graph.nodes.push_back({name, op});
  return heads;
}

bool Layers::fusedSwinLayer(const std::string& name, const std::string& grow, TensorView t, bool shifted,
                            TensorView into) {
  if (!graphOptions.layersFusedOn) return false;
  for (const char* part : {"norm1", "attn.qkv", "attn", "attn.proj", "norm2", "mlp.fc1", "mlp.fc2"})
    if (stored(name + part) != DataType::f16 || storedWeights(name + part) != DataType::f16) return false;
  if (!grow.empty() && storedWeights(grow) != DataType::f16) return false;
  const uint32_t c = t.channels, side = 2 * config.window - 1;
  const auto map = [&](const std::string& part, std::initializer_list<uint32_t> shape) -> SwinLayer::Map {
    return {weight(part + ".weight", shape), weight(part + ".bias", {*shape.begin()})};
  };
  SwinLayer op{.input = t,
               .output = into,
               .norm1 = map(name + "norm1", {c}),
               .norm2 = map(name + "norm2", {c}),
               .qkv = map(name + "attn.qkv", {3 * c, c}),
               .proj = map(name + "attn.proj", {c, c}),
               .fc1 = map(name + "mlp.fc1", {2 * c, c}),
               .fc2 = map(name + "mlp.fc2", {c, 2 * c})};
  if (!grow.empty()) op.grow = map(grow, {into.channels, c, 1, 1});
  op.biasTable = weight(name + "attn.relative_position_bias_table", {side * side, c / config.headChannels});
  op.window = config.window;
  op.headChannels = config.headChannels;
  op.shift = shifted ? config.window / 2 : 0;
  if (!fits(op, *graphOptions.layersFusedOn)) return false;
  graph.nodes.push_back({name + "layer", op});
  return true;
}

bool Layers::isSmall(uint32_t height, uint32_t width) const {
  const uint64_t pixels = uint64_t{height} * width;
  if (const uint64_t most = graphOptions.bandPixels; most > 0)
    return pixels <= most && pixels * config.scale * config.scale <= kSweepPixels * most;
  return pixels <= kWholeColourPixels && pixels * config.scale * config.scale <= kWholeOutputPixels;
}

Sweep Layers::sweep(uint32_t height, uint32_t width) const {
  const uint64_t asked = uint64_t{graphOptions.bandRows} * config.scale;
  if (asked == 0 && isSmall(height / config.scale, width / config.scale)) return {height, kWholeFrame};
  const uint64_t ofGpu = ceilDivide(kSweepPixels * graphOptions.bandPixels, width);
  const uint64_t rows =
      asked > 0 ? asked
                : std::max<uint64_t>({ofGpu, ceilDivide(height, kSweepSteps), ceilDivide(kLeastSweepPixels, width)});
  return {height, alignUp(rows, kSweepUnit)};
}

uint32_t Layers::doublingDistance(uint32_t stage, uint32_t first) const {
  const bool inSquares = graphOptions.inSquares && precision() == DataType::f32;
  uint32_t distance = 0;
  for (uint32_t j = first; j <= stage; ++j) {
    const uint32_t fours = 4 * (config.scale >> (j - 1));  // high-resolution rows of four rows that the stage reads
    distance = alignUp(distance + sweepDistance(), inSquares && kSweepUnit % fours == 0 ? fours : 1);
  }
  return distance;
}

bool Layers::rowsInFours(uint32_t distance, uint32_t rowHeight) {
  return kSweepUnit % (4 * rowHeight) == 0 && distance % (4 * rowHeight) == 0;
}

std::vector<WindowBand> Layers::bands(const TensorView& image, bool shifted, uint32_t tensors) const {
  return windowBands(image.height, config.window, shifted ? config.window / 2 : 0, bandRows(image, tensors));
}

uint64_t Layers::bandRows(const TensorView& image, uint32_t tensors) const {
  if (graphOptions.bandRows > 0) return graphOptions.bandRows;
  if (isSmall(image.height, image.width)) return kWholeFrame;
  const uint64_t ofGpu = ceilDivide(graphOptions.bandPixels, image.width);
  // Narrow features leave room for more rows, wide ones for fewer.
  const uint64_t ofCaches =
      std::min(2 * uint64_t{image.height}, uint64_t{kBandChannels} * image.height / config.channels) / tensors;
  const uint64_t rows = std::max<uint64_t>({ofGpu, ofCaches, ceilDivide(kLeastBandPixels, image.width)});
  // Of whole multiples of eight windows, whose tokens large workgroups share out evenly.
  const uint32_t unit = config.window * (8 / std::gcd(image.width / config.window, 8u));
  return rows < unit ? rows : rows / unit * unit;
}

}  // namespace xrds
