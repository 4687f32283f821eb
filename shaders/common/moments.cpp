#include "shaders/common/moments.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/half.h"

namespace xrds {
namespace {

constexpr double kLargestHalf = 65504, kSmallestHalf = 0x1p-14;  // the smallest that keeps all of its digits
constexpr double kPeak = 8;                                      // standard deviations that a value may reach
constexpr double kWeightNoise = 5e-4;  // of a layer's weights: no half in its range is off by more

// Of max(x, 0) for a normal x: also close enough to GELU and leaky ReLU.
Moment rectified(Moment x) {
  const double s = std::sqrt(x.variance);
  if (s == 0) return {std::max(x.mean, 0.0), 0};
  const double z = x.mean / s, below = std::erfc(-z * std::numbers::sqrt2 / 2) / 2,
               density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
  const double mean = x.mean * below + s * density, square = x.square() * below + x.mean * s * density;
  return {mean, std::max(0.0, square - mean * mean)};
}

}  // namespace

Moment& Moments::at(const TensorView& view, uint32_t channel) {
  std::vector<Moment>& channels = channels_[view.value];
  channels.resize(std::max<size_t>(channels.size(), view.channelStride));
  return channels[view.channelOffset + channel];
}

void Moments::copy(const TensorView& from, const TensorView& to) {
  for (uint32_t c = 0; c < std::min(from.channels, to.channels); ++c) at(to, c) = Moment{at(from, c)};
}

Moment Moments::finished(Moment sum, Activation activation, const TensorView& residual, uint32_t channel) {
  if (activation != Activation::none) sum = rectified(sum);
  return residual.exists() ? sum + at(residual, channel) : sum;
}

// Weights are rounded once, so their error can be known. A layer behind may ask for any one channel, however small.
void Moments::checkWeights(std::span<const float> weights, size_t weightsPerOutput) {
  for (size_t row = 0; row < weights.size(); row += weightsPerOutput) {
    double difference = 0, power = 0;
    for (const float w : weights.subspan(row, weightsPerOutput)) {
      const double error = double{fromHalf(toHalf(w))} - w;
      difference += error * error;
      power += double{w} * w;
    }
    if (difference <= kWeightNoise * kWeightNoise * power) continue;
    foundWeights_.try_emplace(node_, "beyond the range of a half");
    return;
  }
}

void Moments::checkSmall(const TensorView& view) {
  double square = 0;
  for (uint32_t c = 0; c < view.channels; ++c) square = std::max(square, at(view, c).square());
  checkSmall(view.value, square);
}

void Moments::checkSmall(ValueId value, double square) {
  if (square > 0 && std::sqrt(square) < kSmallestHalf) storeInF32(value, "too small for a half");
}

void Moments::checkRanges() {
  for (const auto& [value, channels] : channels_) {
    double peak = 0, square = 0;
    for (const Moment m : channels) {
      peak = std::max(peak, std::abs(m.mean) + kPeak * std::sqrt(m.variance));
      square = std::max(square, m.square());
    }
    if (peak > kLargestHalf) storeInF32(value, "too large for a half");
    checkSmall(value, square);
  }
}

std::span<const float> Moments::gain(const TensorView& view) const {
  const auto found = gains_.find(view.value);
  return found == gains_.end() ? std::span<const float>{} : found->second;
}

}  // namespace xrds
