#include "network/promotion.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/half.h"
#include "shaders/common/transfer.h"

namespace xrds {
namespace {

constexpr double kLargestHalf = 65504, kSmallestHalf = 0x1p-14;  // the smallest that keeps all of its digits
constexpr double kRounding = 0x1p-11 / 1.7320508;                // RMS of the relative error of a half
constexpr double kPeak = 8;                                      // standard deviations that a value may reach
constexpr double kNormNoise = 4e-3;                              // of a layer norm's output, from rounding its input
constexpr double kLogitNoise = 2e-2;   // of a logit, from rounding query and key: the relative error of its exp
constexpr double kWeightNoise = 5e-4;  // of a layer's weights: no half in its range is off by more

struct Moment {
  double mean = 0, variance = 0;
  double square() const { return mean * mean + variance; }
};
Moment operator+(Moment a, Moment b) { return {a.mean + b.mean, a.variance + b.variance}; }

// Of max(x, 0) for a normal x: also close enough to GELU and leaky ReLU.
Moment rectified(Moment x) {
  const double s = std::sqrt(x.variance);
  if (s == 0) return {std::max(x.mean, 0.0), 0};
  const double z = x.mean / s, below = std::erfc(-z * M_SQRT1_2) / 2,
               density = std::exp(-z * z / 2) / std::sqrt(2 * M_PI);
  const double mean = x.mean * below + s * density, square = x.square() * below + x.mean * s * density;
  return {mean, std::max(0.0, square - mean * mean)};
}

/// Carries the moments of every channel of every value through a graph and notes what they ask for.
class MomentFlow {
 public:
  explicit MomentFlow(const Graph& graph) : graph_(graph) {}

  std::vector<Promotion> run() {
    for (const Node& node : graph_.nodes) {
      node_ = &node;
      std::visit([&](const auto& op) { follow(op); }, node.op);
    }
    for (const auto& [value, channels] : moments_) checkRange(graph_.values[value].name, channels);
    std::vector<Promotion> promotions;
    for (auto& [key, reason] : found_) promotions.push_back({key.first, key.second, reason});
    return promotions;
  }

 private:
  using Channels = std::vector<Moment>;

  Moment& at(const TensorView& view, uint32_t channel) {
    Channels& channels = moments_[view.value];
    channels.resize(std::max<size_t>(channels.size(), view.channelStride));
    return channels[view.channelOffset + channel];
  }
  double mean(const TensorView& view, auto term) {
    double sum = 0;
    for (uint32_t c = 0; c < view.channels; ++c) sum += term(at(view, c));
    return sum / view.channels;
  }
  void note(const std::string& name, bool weights, std::string reason) {
    found_.try_emplace({name, weights}, std::move(reason));
  }
  void copy(const TensorView& from, const TensorView& to) {
    for (uint32_t c = 0; c < std::min(from.channels, to.channels); ++c) at(to, c) = at(from, c);
  }
  Moment finished(Moment sum, Activation activation, const TensorView& residual, uint32_t channel) {
    if (activation != Activation::none) sum = rectified(sum);
    return residual.exists() ? sum + at(residual, channel) : sum;
  }

  // What images hold: T of radiances around mid-grey, albedos, unit normals.
  void follow(const Exposure&) {}
  void follow(const EncodeRadiance& op) {
    for (uint32_t c = 0; c < 3; ++c) at(op.output, c) = {1, 2};
  }
  void follow(const PackAuxiliary& op) {
    for (uint32_t c = 0; c < op.output.channels; ++c) {
      const auto channel = static_cast<int>(c) - op.albedoOffset;
      const bool albedo = op.albedoOffset >= 0 && channel >= 0 && channel < 3;
      at(op.output, c) = albedo ? Moment{0.5, 0.1} : Moment{0, 0.33};
    }
  }
  void follow(const BoxMean& op) { copy(op.input, op.output); }
  void follow(const FilterAuxiliary& op) { copy(op.aux, op.output); }
  void follow(const Bicubic&) {}  // from here on fp32
  void follow(const JointBilateral&) {}
  void follow(const RadianceCeiling&) {}
  void follow(const DecodeRadiance&) {}

  void follow(const Linear& op) {
    const uint32_t own = op.input.channels, inputs = inputChannels(op);
    XRDS_CHECK_EQ(op.norm.weight.size(), 0u);  // graphs are looked at with norms of their own
    const std::vector<float> weight = joinedWeight(op), bias = joinedBias(op);
    for (uint32_t o = 0; o < bias.size(); ++o) {
      Moment sum{bias[o], 0};
      for (uint32_t i = 0; i < inputs; ++i) {
        const double w = weight[size_t{o} * inputs + i];
        const Moment x = i < own ? at(op.input, i) : at(op.appended, i - own);
        sum = sum + Moment{w * x.mean, w * w * x.variance};
      }
      at(op.output, o) = finished(sum, op.activation, op.residual, o);
    }
    checkWeights(weight, inputs);
    const auto gain = gains_.find(op.input.value);
    if (gain == gains_.end()) return;
    std::vector<float> normed = weight;  // as a layer that makes the norm stores them
    for (size_t i = 0; i < normed.size(); ++i) normed[i] *= gain->second[i % inputs];
    checkWeights(normed, inputs);
  }

  void follow(const Conv3x3& op) {
    const uint32_t inputGroup = op.unshuffleInput ? 4 : 1, outputGroup = op.shuffleOutput ? 4 : 1;
    for (uint32_t o = 0; o < op.outputChannels; ++o) {
      Moment sum{op.bias[o], 0};
      for (uint32_t i = 0; i < op.inputChannels; ++i) {
        double taps = 0, squares = 0;
        for (const float w : op.weight.subspan((size_t{o} * op.inputChannels + i) * 9, 9)) taps += w, squares += w * w;
        const Moment x = at(op.input, i / inputGroup);
        sum = sum + Moment{taps * x.mean, std::max(taps * taps, squares) * x.variance};
      }
      const uint32_t channel = o / outputGroup;
      const Moment y = finished(sum, op.activation, op.residual, channel);
      Moment& stored = at(op.output, channel);
      if (o % outputGroup == 0 || y.square() > stored.square()) stored = y;
    }
    checkWeights(op.weight, op.inputChannels * 9);
  }

  // A pixel is in the patches of four pixels, with four of their 16 elements.
  void follow(const Fold& op) {
    constexpr uint32_t kPatch = 16, kPatches = 4;
    for (uint32_t n = 0; n < op.input.channels / kPatch; ++n) {
      Moment sum;
      for (uint32_t i = 0; i < kPatch; ++i) sum = sum + at(op.input, n * kPatch + i);
      at(op.output, n) = {sum.mean / kPatches, sum.variance / kPatches};
    }
  }

  void follow(const LayerNorm& op) {
    gains_[op.output.value] = op.weight;
    const double centre = mean(op.input, [](Moment m) { return m.mean; });
    const double spread = std::sqrt(
        op.epsilon + mean(op.input, [&](Moment m) { return m.variance + (m.mean - centre) * (m.mean - centre); }));
    const double rms = std::sqrt(mean(op.input, [](Moment m) { return m.square(); }));
    if (kRounding * rms > kNormNoise * spread)
      note(graph_.values[op.input.value].name, false, "its mean drowns what the layer norm behind it looks for");
    for (uint32_t c = 0; c < op.input.channels; ++c) {
      const Moment x = at(op.input, c);
      const double scale = op.weight[c] / spread;
      at(op.output, c) = {(x.mean - centre) * scale + op.bias[c], x.variance * scale * scale};
    }
  }

  void follow(const WindowAttention& op) {
    for (uint32_t first = 0; first < op.queries.channels; first += op.headChannels) {
      double squares = 0;
      for (uint32_t c = first; c < first + op.headChannels; ++c)
        squares += at(op.queries, c).square() * at(op.keys, c).square();
      if (kRounding * std::sqrt(2 * squares / op.headChannels) < kLogitNoise) continue;
      for (const TensorView& view : {op.queries, op.keys})
        note(graph_.values[view.value].name, false, "large logits of attention");
    }
    // These may be slices of one tensor, of which checkRange() sees the largest alone.
    for (const TensorView& view : {op.queries, op.keys, op.values}) {
      double square = 0;
      for (uint32_t c = 0; c < view.channels; ++c) square = std::max(square, at(view, c).square());
      checkSmall(graph_.values[view.value].name, square);
    }
    copy(op.values, op.output);
  }

  void follow(const SwinLayer&) { throw std::logic_error("layers are fused after what they store is known"); }

  void checkRange(const std::string& name, const Channels& channels) {
    double peak = 0, square = 0;
    for (const Moment m : channels) {
      peak = std::max(peak, std::abs(m.mean) + kPeak * std::sqrt(m.variance));
      square = std::max(square, m.square());
    }
    if (peak > kLargestHalf) note(name, false, "too large for a half");
    checkSmall(name, square);
  }

  void checkSmall(const std::string& name, double square) {
    if (square > 0 && std::sqrt(square) < kSmallestHalf) note(name, false, "too small for a half");
  }

  // Weights are rounded once, so their error can be known. A layer behind may ask for any one channel, however small.
  void checkWeights(std::span<const float> weights, size_t weightsPerOutput) {
    for (size_t row = 0; row < weights.size(); row += weightsPerOutput) {
      double difference = 0, power = 0;
      for (const float w : weights.subspan(row, weightsPerOutput)) {
        const double error = double{fromHalf(toHalf(w))} - w;
        difference += error * error;
        power += double{w} * w;
      }
      if (difference <= kWeightNoise * kWeightNoise * power) continue;
      return note(node_->name, true, "beyond the range of a half");
    }
  }

  const Graph& graph_;
  const Node* node_ = nullptr;
  std::map<ValueId, Channels> moments_;
  std::map<ValueId, std::span<const float>> gains_;  // of the norms that made the values
  std::map<std::pair<std::string, bool>, std::string> found_;
};

}  // namespace

std::vector<Promotion> findPromotions(const Graph& graph) { return MomentFlow(graph).run(); }

}  // namespace xrds
