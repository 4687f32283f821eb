#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/tensor.h"
#include "shaders/common/activation.h"

namespace xrds {

/// Of a channel, over the pixels of natural images.
struct Moment {
  double mean = 0, variance = 0;
  double square() const { return mean * mean + variance; }
};
inline Moment operator+(Moment a, Moment b) { return {a.mean + b.mean, a.variance + b.variance}; }

/// RMS of the relative error of a half.
inline constexpr double kHalfRounding = 0x1p-11 / 1.7320508;

/// The moments of every channel of every value, which operators carry from what they read to what they write, and what
/// they find that 16 bits cannot store. Channels count as independent, neighbouring pixels as equal.
class Moments {
 public:
  Moment& at(const TensorView& view, uint32_t channel);
  void copy(const TensorView& from, const TensorView& to);
  /// Behind an activation and a residual sum.
  Moment finished(Moment sum, Activation activation, const TensorView& residual, uint32_t channel);

  /// The operator whose findings follow.
  void beginOperator(size_t node) { node_ = node; }
  void storeInF32(const TensorView& view, const char* reason) { storeInF32(view.value, reason); }
  /// Notes the operator's weights if a half cannot hold them to half a unit in the last place.
  void checkWeights(std::span<const float> weights, size_t weightsPerOutput);
  /// Notes the value if its channels stay below the smallest normal half.
  void checkSmall(const TensorView& view);
  /// Notes every value that comes near the largest half or stays below the smallest normal one.
  void checkRanges();

  /// The weights of the layer norm that made the view; empty if none did.
  void setGain(const TensorView& view, std::span<const float> gain) { gains_[view.value] = gain; }
  std::span<const float> gain(const TensorView& view) const;

  /// Of values and of operators' weights, by index.
  const std::map<ValueId, std::string>& values() const { return foundValues_; }
  const std::map<size_t, std::string>& weights() const { return foundWeights_; }

 private:
  void storeInF32(ValueId value, const char* reason) { foundValues_.try_emplace(value, reason); }
  void checkSmall(ValueId value, double square);

  size_t node_ = 0;
  std::map<ValueId, std::vector<Moment>> channels_;
  std::map<ValueId, std::span<const float>> gains_;
  std::map<ValueId, std::string> foundValues_;
  std::map<size_t, std::string> foundWeights_;
};

}  // namespace xrds
