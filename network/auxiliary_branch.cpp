#include "network/auxiliary_branch.h"

#include <algorithm>

namespace xrds {
namespace {

uint32_t above(uint32_t row, uint32_t rows) { return row - std::min(row, rows); }

RowRange divided(RowRange rows, uint32_t divisor) { return {rows.begin / divisor, rows.end / divisor}; }

/// The branch as a sweep: stage 2i makes H_i, stage 2i - 1 the inner convolution of block i, stage 2i + 1 + j the step
/// j of deshuffle_i, each as many rows behind the stage before.
class AuxiliaryBranch {
 public:
  AuxiliaryBranch(Layers& layers, TensorView aux)
      : layers_(layers), aux_(aux), sweep_(layers.sweep(aux.height, aux.width)) {
    const NetworkConfig& config = layers_.config;
    for (uint32_t i = 0; i <= config.groups; ++i) {
      features_.push_back(rolling(i == 0 ? "aux_conv" : blockName(i) + "conv2", 1));
      inner_.push_back(rolling(blockName(i) + "conv1", 1));
      for (uint32_t j = 0; j + 1 < config.steps(); ++j) deshuffled_.push_back(rolling(stepName(i, j), 2u << j));
      result_.d.push_back(layers_.create("deshuffle." + std::to_string(i), low(), config.channels));
    }
    if (config.auxSkip) result_.h = layers_.create("aux_features", aux, config.auxChannels);
  }

  AuxiliaryFeatures build() {
    const uint32_t groups = layers_.config.groups, last = 2 * groups + std::max(1u, layers_.config.steps());
    for (uint32_t step = 0; step < sweep_.stepCount(last * layers_.sweepDistance()); ++step)
      for (uint32_t i = 0; i <= groups; ++i) {
        makeFeatures(step, i);
        deshuffle(step, i);
      }
    return result_;
  }

 private:
  static std::string blockName(uint32_t i) { return "aux_blocks." + std::to_string(i - 1) + "."; }
  static std::string stepName(uint32_t i, uint32_t j) {
    return "deshuffle." + std::to_string(i) + "." + std::to_string(j);
  }
  TensorView low() const {
    return {.height = aux_.height / layers_.config.scale, .width = aux_.width / layers_.config.scale};
  }
  RollingTensor rolling(const std::string& name, uint32_t divisor) const {
    return {name, layers_.stored(name), {aux_.height / divisor, aux_.width / divisor, layers_.config.auxChannels}};
  }
  RowRange rows(uint32_t step, uint32_t stage) const { return sweep_.rows(step, stage * layers_.sweepDistance()); }

  // Where a stage writes its rows; two rows above those that the next stage makes are still read, by a deshuffle, and
  // those of the stage after it, by a residual.
  TensorView advance(RollingTensor& tensor, uint32_t step, uint32_t stage, uint32_t divisor) {
    const uint32_t next = rows(step, stage + 1).begin / divisor, second = rows(step, stage + 2).begin / divisor;
    return tensor.advance(layers_.graph, divided(rows(step, stage), divisor), std::min(above(next, 2), second));
  }

  const TensorView& features(uint32_t i) const {
    return i == layers_.config.groups && result_.h.exists() ? result_.h : features_[i].view();
  }

  // H_0 = conv3x3(aux); H_i = H_{i-1} + conv3x3(relu(conv3x3(H_{i-1}))).
  void makeFeatures(uint32_t step, uint32_t i) {
    const uint32_t ca = layers_.config.auxChannels;
    if (const RowRange inner = rows(step, 2 * i - 1); i > 0 && inner.begin < inner.end)
      layers_.conv(blockName(i) + "conv1", features(i - 1), ca, ca,
                   {.into = advance(inner_[i], step, 2 * i - 1, 1),
                    .activation = Activation::relu,
                    .rows = inner,
                    .inFours = true});
    const RowRange made = rows(step, 2 * i);
    if (made.begin == made.end) return;
    const bool whole = i == layers_.config.groups && result_.h.exists();
    const TensorView into = whole ? result_.h : advance(features_[i], step, 2 * i, 1);
    if (i == 0)
      layers_.conv("aux_conv", aux_, layers_.config.auxWidth(), ca, {.into = into, .rows = made, .inFours = true});
    else
      layers_.conv(blockName(i) + "conv2", inner_[i].view(), ca, ca,
                   {.into = into, .residual = features(i - 1), .rows = made, .inFours = true});
  }

  // D_i = deshuffle_i(H_i): n steps of pixel-unshuffle and convolution, the last one to C channels.
  void deshuffle(uint32_t step, uint32_t i) {
    const NetworkConfig& config = layers_.config;
    const uint32_t steps = config.steps();
    TensorView x = features(i);
    for (uint32_t j = 0; j < std::max(1u, steps); ++j) {
      const bool last = j + 1 >= steps, unshuffle = steps > 0;
      const uint32_t stage = 2 * i + 1 + j, divisor = unshuffle ? 2u << j : 1;
      RollingTensor* rolling = last ? nullptr : &deshuffled_[i * (steps - 1) + j];
      if (const RowRange made = divided(rows(step, stage), divisor); made.begin < made.end) {
        const TensorView into = last ? result_.d[i] : advance(*rolling, step, stage, divisor);
        layers_.conv(stepName(i, j), x, x.channels * (unshuffle ? 4 : 1), into.channels,
                     {.into = into,
                      .activation = last ? Activation::none : Activation::relu,
                      .unshuffle = unshuffle,
                      .rows = made,
                      .inFours = true});
      }
      if (!last) x = rolling->view();
    }
  }

  Layers& layers_;
  TensorView aux_;
  Sweep sweep_;
  std::vector<RollingTensor> features_, inner_,
      deshuffled_;  // H_i, the inner features of block i, steps of deshuffle_i
  AuxiliaryFeatures result_;
};

}  // namespace

AuxiliaryFeatures auxiliaryBranch(Layers& layers, TensorView aux) { return AuxiliaryBranch(layers, aux).build(); }

}  // namespace xrds
