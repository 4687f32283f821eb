#include "network/super_resolution.h"

#include <algorithm>
#include <bit>

#include "network/fields.h"

namespace xrds {
namespace {

constexpr const char* kTransfers[] = {"none", "log1p"};
constexpr uint32_t kColours = 3, kPatch = 16;  // pixels of a patch of Fold

/// A convolution to four times the channels and a pixel shuffle.
struct Doubling {
  std::string name;
  uint32_t channels = 0;  // behind the shuffle
};

/// Stage j makes the j-th doubling, stage n + 1 the output convolution, if there is one, and the picture. Where maps
/// are joined, the last doubling and the output convolution are one, which makes patches of the output at half the
/// resolution.
class Doublings {
 public:
  Doublings(Layers& layers, const TensorView& u, const Prepared& prepared, const std::vector<Doubling>& doublings,
            const std::string& output)
      : layers_(layers), graph_(layers.graph), doublings_(doublings), output_(output), u_(u), prepared_(prepared) {
    const uint32_t scale = layers.config.scale, height = scale * u.height, width = scale * u.width;
    folded_ = layers.joinsMaps() && !doublings.empty() && !output.empty() &&
              kPatch * kColours < 4 * doublings.back().channels;
    sweep_ = layers.sweep(height, width);
    for (uint32_t j = 1; j <= doublings.size(); ++j) {
      const bool patches = folded_ && j == doublings.size();
      const auto& [name, channels] = doublings[j - 1];
      const uint32_t divisor = divisorOf(j);
      tensors_.emplace_back(patches ? "patches" : name + ".shuffled", layers.stored(name),
                            TensorShape{height / divisor, width / divisor, patches ? kPatch * kColours : channels});
    }
    if (!output.empty()) tensors_.emplace_back("out", layers.stored(output), TensorShape{height, width, 4});
  }

  void build() {
    const auto last = static_cast<uint32_t>(doublings_.size()) + 1;
    const uint32_t steps = sweep_.stepCount(distanceOf(last));
    for (uint32_t step = 0; step < steps; ++step) {
      for (uint32_t j = 1; j < last; ++j) makeDoubling(step, j);
      makePicture(rows(step, last));
    }
    if (steps == 1) graph_.network = tensors_.back().view();
  }

 private:
  uint32_t distanceOf(uint32_t stage) const { return layers_.doublingDistance(stage, 2); }
  RowRange rows(uint32_t step, uint32_t stage) const { return sweep_.rows(step, distanceOf(stage)); }
  // Output pixels of a stage's, to a side.
  uint32_t divisorOf(uint32_t stage) const {
    return folded_ && stage == doublings_.size() ? 2 : layers_.config.scale >> stage;
  }
  bool rowsInFours(uint32_t stage) const {
    return layers_.rowsInFours(distanceOf(stage), layers_.config.scale >> (stage - 1));
  }
  const TensorView& before(uint32_t stage) const { return stage == 1 ? u_ : tensors_[stage - 2].view(); }

  void makeDoubling(uint32_t step, uint32_t j) {
    const auto& [name, channels] = doublings_[j - 1];
    const uint32_t divisor = divisorOf(j);
    const RowRange made{rows(step, j).begin / divisor, rows(step, j).end / divisor};
    if (made.begin == made.end) return;
    const uint32_t next = rows(step, j + 1).begin / divisor;  // whose convolution reads the row above
    const TensorView into = tensors_[j - 1].advance(graph_, made, next - std::min(next, 1u));
    if (folded_ && j == doublings_.size())
      layers_.patchesOfDoubling(name, output_, before(j), channels, kColours, into, made, rowsInFours(j));
    else
      layers_.conv(name, before(j), before(j).channels, 4 * channels,
                   {.into = into,
                    .shuffle = true,
                    .rows = {made.begin / 2, made.end / 2},
                    .inFours = true,
                    .rowsInFours = rowsInFours(j)});
  }

  void makePicture(RowRange made) {
    if (made.begin == made.end) return;
    const auto stage = static_cast<uint32_t>(doublings_.size()) + 1;
    if (!output_.empty()) {
      const TensorView out = tensors_.back().advance(graph_, made, made.begin);
      if (folded_)
        graph_.nodes.push_back({output_, Fold{before(stage), out, made}});
      else
        layers_.conv(output_, before(stage), before(stage).channels, kColours,
                     {.into = out, .rows = made, .inFours = true});
    }
    const uint32_t height = graph_.output.height;
    const RowRange real{std::min(made.begin, height), std::min(made.end, height)};
    if (real.begin < real.end)
      decodeRows(layers_.config, graph_, {prepared_, prepared_.x, {}}, tensors_.back().view(), real);
  }

  Layers& layers_;
  Graph& graph_;
  const std::vector<Doubling>& doublings_;
  const std::string& output_;
  TensorView u_;
  const Prepared& prepared_;
  bool folded_ = false;
  Sweep sweep_;
  std::vector<RollingTensor> tensors_;  // of the stages
};

// pixel_shuffle(x, 2 t) of 3 (2 t)^2 channels is pixel_shuffle(pixel_shuffle(x', 2), t), where x' has these channels of
// x in its place.
std::vector<uint32_t> channelsForDoubling(uint32_t t) {
  std::vector<uint32_t> from;
  for (uint32_t p = 0; p < kColours * t * t; ++p)
    for (uint32_t phase = 0; phase < 4; ++phase) {
      const uint32_t colour = p / (t * t), y = phase / 2 * t + p / t % t, x = phase % 2 * t + p % t;
      from.push_back(colour * 4 * t * t + y * 2 * t + x);
    }
  return from;
}

// The rows of a convolution [O][inputs][3][3] and its bias in that order, the last four times where channels are
// rounded up.
void deriveReordered(Layers& layers, const std::string& name, std::span<const float> weight,
                     std::span<const float> bias, const std::vector<uint32_t>& from) {
  const size_t row = weight.size() / bias.size(), rows = alignUp(static_cast<uint32_t>(from.size()), 16);
  std::vector<float> weights(rows * row), biases(rows);
  for (size_t i = 0; i < from.size(); ++i) {
    std::copy_n(weight.begin() + static_cast<std::ptrdiff_t>(from[i] * row), row,
                weights.begin() + static_cast<std::ptrdiff_t>(i * row));
    biases[i] = bias[from[i]];
  }
  layers.derive(name + ".weight", std::move(weights));
  layers.derive(name + ".bias", std::move(biases));
}

// A convolution that leaves `channels` as they are.
ConvWeights identity(Layers& layers, uint32_t channels) {
  std::vector<float> weight(size_t{9} * channels * channels);
  for (uint32_t c = 0; c < channels; ++c) weight[(size_t{c} * channels + c) * 9 + 4] = 1;
  return {layers.graph.keep(std::move(weight)), layers.graph.keep(std::vector<float>(channels))};
}

}  // namespace

void parseSuperResolution(const Metadata& metadata, NetworkConfig& config) {
  config.scale = number(metadata, "scale", 1, 16);
  require(std::has_single_bit(config.scale),
          "gives scale " + std::to_string(config.scale) + ", expected 1, 2, 4, 8 or 16");
  config.channels = number(metadata, "channels", 4, 512);
  require(config.channels % 4 == 0, "gives channels that are no multiple of 4");
  config.transfer = static_cast<Transfer>(choice(metadata, "transfer", kTransfers));
  config.auxInputs = {};
  config.auxChannels = 0;
  config.groups = config.blocks = 1;
  config.window = 4;  // no attention: pixels of a row that a kernel rounds together
  config.padding = Padding::columns;
  config.base = BaseImage::none;
}

void describeSuperResolution(const NetworkConfig& config, Metadata& metadata) {
  metadata["scale"] = std::to_string(config.scale);
  metadata["channels"] = std::to_string(config.channels);
  metadata["transfer"] = kTransfers[static_cast<size_t>(config.transfer)];
}

void parseRange(const Metadata& metadata, NetworkConfig& config) {
  config.symbols["range"] = metadata.contains("range") ? number(metadata, "range", 1, 255) : 1;
}

void describeRange(const NetworkConfig& config, Metadata& metadata) {
  metadata["range"] = std::to_string(config.symbol("range"));
}

Prepared prepareFrame(Layers& layers, FrameShape frame) {
  Graph& graph = layers.graph;
  const uint32_t scale = layers.config.scale;
  const Prepared prepared = prepareInputs(layers.config, frame, layers.graphOptions, graph);
  graph.output = graph.create("output", DataType::f32, {scale * frame.height, scale * frame.width, 4});
  return prepared;
}

TensorView normalizedColour(Layers& layers, const TensorView& x) {
  const auto range = static_cast<float>(layers.config.symbol("range"));
  const std::span<const float> mean = layers.weight("mean", {kColours});
  std::vector<float> weight(16), bias(4);
  for (uint32_t c = 0; c < kColours; ++c) {
    weight[5 * c] = range;
    bias[c] = -range * mean[c];
  }
  Linear op{.input = x, .output = layers.create("normalized", x, 4)};
  op.weight = layers.graph.keep(std::move(weight));
  op.bias = layers.graph.keep(std::move(bias));
  layers.graph.nodes.push_back({"normalized", op});
  return op.output;
}

void denormalize(Layers& layers, const std::string& name, uint32_t inputs, uint32_t outputs) {
  const auto range = static_cast<float>(layers.config.symbol("range"));
  const std::span<const float> mean = layers.weight("mean", {kColours});
  const std::span<const float> weight = layers.weight(name + ".weight", {outputs, inputs, 3, 3});
  const std::span<const float> bias = layers.weight(name + ".bias", {outputs});
  std::vector<float> scaled(weight.begin(), weight.end()), shifted(bias.begin(), bias.end());
  for (float& value : scaled) value /= range;
  for (uint32_t c = 0; c < outputs; ++c) shifted[c] = shifted[c] / range + mean[c / (outputs / kColours)];
  layers.derive(name + ".weight", std::move(scaled));
  layers.derive(name + ".bias", std::move(shifted));
}

void upscale(Layers& layers, const TensorView& u, const Prepared& prepared, const std::vector<std::string>& doublings,
             const std::string& output, uint32_t channels) {
  std::vector<Doubling> all;
  all.reserve(doublings.size());
  for (const std::string& name : doublings) all.push_back({name, channels > 0 ? channels : u.channels});
  Doublings(layers, u, prepared, all, output).build();
}

void upscaleFromTrunk(Layers& layers, const std::string& last, const TensorView& f, const TensorView& head,
                      const Prepared& prepared) {
  const uint32_t c = f.channels;
  const TensorView u = layers.conv(last, f, c, c, {.residual = head, .inFours = true});
  denormalize(layers, "tail.1", c, kColours);
  upscale(layers, u, prepared, doublingNames(layers.config, "tail.0."), "tail.1");
}

void upscaleDirectly(Layers& layers, const TensorView& u, const Prepared& prepared, const std::string& name) {
  const uint32_t scale = layers.config.scale, outputs = kColours * scale * scale;
  std::vector<Doubling> all;
  for (uint32_t t = scale / 2; t > 0; t /= 2) {
    const bool first = all.empty();
    const ConvWeights conv = first ? ConvWeights{layers.weight(name + ".weight", {outputs, u.channels, 3, 3}),
                                                 layers.weight(name + ".bias", {outputs})}
                                   : identity(layers, 4 * kColours * t * t);
    all.push_back({first ? name : name + ".shuffle" + std::to_string(t), alignUp(kColours * t * t, 4)});
    deriveReordered(layers, all.back().name, conv.weight, conv.bias, channelsForDoubling(t));
  }
  const std::string output = all.empty() ? name : "";
  Doublings(layers, u, prepared, all, output).build();
}

std::vector<std::string> doublingNames(const NetworkConfig& config, const std::string& prefix) {
  std::vector<std::string> names;
  for (uint32_t j = 0; j < config.steps(); ++j) names.push_back(prefix + std::to_string(2 * j));
  return names;
}

}  // namespace xrds
