#include "network/upsampling.h"

#include <algorithm>

namespace xrds {
namespace {

/// The upscaling as a sweep: stage 0 makes leaky_relu(conv3x3(u)), stage j the j-th doubling, stage n + 1 the output
/// convolution and the auxiliary images that its logits filter; the base image and the decoding come last. Nothing but
/// shuffling stands between the last doubling and the output convolution: where that is less work, they are joined.
/// With a 1x1 one, stage n makes the output; with a 3x3 one, it makes patches of it, at half the resolution.
class Upsampling {
 public:
  Upsampling(Layers& layers, TensorView u, TensorView h, const Prepared& prepared, TensorView prefiltered)
      : layers_(layers), graph_(layers.graph), config_(layers.config), u_(u), h_(h), prepared_(prepared) {
    decoded_ = {prepared, prepared.x, prepared.aux};
    if (prefiltered.exists()) decoded_.base.x = prefiltered;
    const TensorView& output = graph_.output;
    tail_ = tailOf(layers);
    sweep_ = layers.sweep(u.exists() ? config_.scale * u.height : output.height, output.width);
    if (!u.exists()) return;
    for (uint32_t j = 0; j < outputStage(); ++j) {
      const bool last = j == config_.steps(), folded = last && tail_ == Tail::folded;
      const std::string name = last ? "upscaled" : j == 0 ? "up_pre" : "up." + std::to_string(j - 1);
      const uint32_t skipped = last && copiesFeatures() ? config_.auxChannels : 0, divisor = divisorOf(j);
      doublings_.emplace_back(name, layers.stored(name),
                              TensorShape{config_.scale * u.height / divisor, config_.scale * u.width / divisor,
                                          folded ? kPatch * config_.outputWidth() : config_.channels + skipped});
    }
    const uint32_t outputs = ceilDivide(config_.outputWidth(), 4) * 4;
    out_ = {"out", layers.stored("out"), {config_.scale * u.height, config_.scale * u.width, outputs}};
    if (config_.auxKernels == 0) return;
    filtered_ = {"filtered.auxiliary",
                 layers.stored("filtered.auxiliary"),
                 {output.height, output.width, prepared.aux.channels}};
    decoded_.base.x = prefiltered;
    createEncoded(config_, "filtered.", graph_.colour.height, graph_.colour.width, graph_, decoded_.base);
    if (!prefiltered.exists()) decoded_.x = decoded_.base.x;
  }

  void build() {
    const uint32_t steps = sweep_.stepCount(decodeDistance());
    for (uint32_t step = 0; step < steps; ++step) {
      for (uint32_t j = 0; u_.exists() && j < outputStage(); ++j) makeDoubling(step, j);
      if (u_.exists()) makeOutput(step);
      const RowRange rows = real(sweep_.rows(step, decodeDistance()));
      if (rows.begin < rows.end) decodeRows(config_, graph_, decoded_, out_.view(), rows);
    }
    if (steps == 1) graph_.network = out_.view();
  }

 private:
  enum class Tail : uint8_t { convolved, joined, folded };  // how the output convolution is made
  static constexpr uint32_t kPatch = 16;                    // pixels of a patch

  // Joined, the last doubling has as many outputs as the output convolution asks for, in place of 4 C.
  static Tail tailOf(const Layers& layers) {
    const NetworkConfig& config = layers.config;
    if (!layers.joinsMaps() || config.steps() == 0) return Tail::convolved;
    if (config.outputSide == 1)
      return alignUp(config.outputWidth(), 4) < config.channels ? Tail::joined : Tail::convolved;
    return kPatch * config.outputWidth() < 4 * config.channels && !config.auxSkip ? Tail::folded : Tail::convolved;
  }
  // A 3x3 output convolution reads one tensor, a 1x1 one the auxiliary features where they are.
  bool copiesFeatures() const { return config_.auxSkip && config_.outputSide == 3; }
  uint32_t outputStage() const { return tail_ == Tail::joined ? config_.steps() : config_.steps() + 1; }
  // Output pixels of a stage's, to a side.
  uint32_t divisorOf(uint32_t stage) const {
    return tail_ == Tail::folded && stage == config_.steps() ? 2 : config_.scale >> stage;
  }
  uint32_t distanceOf(uint32_t stage) const { return layers_.doublingDistance(stage, 1); }
  RowRange rows(uint32_t step, uint32_t stage) const { return sweep_.rows(step, distanceOf(stage)); }
  bool rowsInFours(uint32_t stage) const {
    return layers_.rowsInFours(distanceOf(stage), layers_.config.scale >> (stage - 1));
  }
  // The base image reads the means of the filtered images two low-resolution rows below its own.
  uint32_t decodeDistance() const {
    if (!u_.exists()) return 0;
    const uint32_t below = config_.auxKernels > 0 ? std::max(layers_.sweepDistance(), 2 * config_.scale) : 0;
    return distanceOf(outputStage()) + below;
  }
  RowRange real(RowRange rows) const {
    return {std::min(rows.begin, graph_.output.height), std::min(rows.end, graph_.output.height)};
  }

  void makeDoubling(uint32_t step, uint32_t j) {
    const uint32_t c = config_.channels, divisor = divisorOf(j);
    const RowRange made{rows(step, j).begin / divisor, rows(step, j).end / divisor};
    if (made.begin == made.end) return;
    const uint32_t next = rows(step, j + 1).begin / divisor;  // whose convolution reads the row above
    const TensorView all = doublings_[j].advance(graph_, made, next - std::min(next, 1u));
    if (j == config_.steps() && tail_ == Tail::folded)
      return layers_.patchesOfDoubling("up." + std::to_string(j - 1), "out", doublings_[j - 1].view(), c,
                                       config_.outputWidth(), all, made, rowsInFours(j));
    const TensorView into = slice(all, 0, c);
    if (j == 0)
      layers_.conv("up_pre", u_, c, c, {.into = into, .activation = Activation::leakyRelu, .rows = made});
    else
      layers_.conv("up." + std::to_string(j - 1), doublings_[j - 1].view(), c, 4 * c,
                   {.into = into,
                    .shuffle = true,
                    .rows = {made.begin / 2, made.end / 2},
                    .inFours = true,
                    .rowsInFours = rowsInFours(j)});
    if (j == config_.steps() && copiesFeatures()) copyRows(graph_, "aux_skip", h_, slice(all, c, h_.channels), made);
  }

  // The raw output, and what its logits make of the auxiliary images.
  void makeOutput(uint32_t step) {
    const RowRange made = rows(step, outputStage());
    if (made.begin == made.end) return;
    const uint32_t keep = sweep_.rows(step, decodeDistance()).begin;
    const TensorView& upscaled = doublings_.back().view();
    const TensorView out = out_.advance(graph_, made, keep);
    if (tail_ == Tail::folded)
      graph_.nodes.push_back({"out", Fold{upscaled, out, made}});
    else if (tail_ == Tail::joined)
      layers_.outputOfDoubling("up." + std::to_string(config_.steps() - 1), "out", upscaled, h_, config_.outputWidth(),
                               out, made, rowsInFours(outputStage()));
    else if (config_.outputSide == 1)
      layers_.conv1x1Rows("out", upscaled, h_, config_.outputWidth(), out, made);
    else
      layers_.conv("out", upscaled, upscaled.channels, config_.outputWidth(),
                   {.into = out, .rows = made, .inFours = true});
    const RowRange filtered = real(made);
    if (config_.auxKernels == 0 || filtered.begin == filtered.end) return;
    Prepared& base = decoded_.base;
    base.aux = filtered_.advance(graph_, filtered, std::min(keep, filtered.begin));
    graph_.nodes.push_back(
        {"filter_auxiliary",
         FilterAuxiliary{prepared_.aux, out_.view(), base.aux, config_.auxKernels, config_.firstAuxLogit(), filtered}});
    const RowRange low{filtered.begin / config_.scale, filtered.end / config_.scale};
    if (config_.prefilter > 0)
      meanRows(config_, "filtered.", graph_, base, low);
    else
      encodeRows(config_, "filtered.", graph_, base, low);
  }

  Layers& layers_;
  Graph& graph_;
  const NetworkConfig& config_;
  TensorView u_, h_;
  Tail tail_ = Tail::convolved;
  Prepared prepared_;  // the images as given
  Decoded decoded_;    // with them filtered
  Sweep sweep_;
  std::vector<RollingTensor> doublings_;
  RollingTensor out_, filtered_;
};

}  // namespace

void upsample(Layers& layers, TensorView u, TensorView h, const Prepared& prepared, TensorView prefiltered) {
  Upsampling(layers, u, h, prepared, prefiltered).build();
}

}  // namespace xrds
