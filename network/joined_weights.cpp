#include "network/joined_weights.h"

#include <algorithm>

#include "engine/dispatch.h"

namespace xrds {
namespace {

constexpr uint32_t kTaps = 9, kParts = 4;  // of a convolution; pixels that a pixel becomes
constexpr int kPatch = 4;                  // its side

uint32_t channelsBehind(ConvWeights doubling) { return static_cast<uint32_t>(doubling.bias.size()) / kParts; }

/// Sums of outputs of a doubling's convolution.
class DoublingSum {
 public:
  explicit DoublingSum(ConvWeights doubling)
      : doubling_(doubling), row_(doubling.weight.size() / doubling.bias.size()) {}

  /// Adds w times channel k of that part of the shuffled pixels: parts are (0, 0), (0, 1), (1, 0), (1, 1).
  void add(double w, uint32_t k, uint32_t part) {
    const size_t from = size_t{k} * kParts + part;
    bias_ += w * doubling_.bias[from];
    for (size_t i = 0; i < row_.size(); ++i) row_[i] += w * doubling_.weight[from * row_.size() + i];
  }
  void add(double bias) { bias_ += bias; }
  void appendTo(JoinedWeights& joined) {
    joined.weight.insert(joined.weight.end(), row_.begin(), row_.end());
    joined.bias.push_back(static_cast<float>(bias_));
  }

 private:
  ConvWeights doubling_;
  std::vector<double> row_;
  double bias_ = 0;
};

}  // namespace

JoinedWeights joinedWithOutput(ConvWeights doubling, ConvWeights output) {
  const uint32_t channels = channelsBehind(doubling);
  const size_t outputs = output.bias.size(), outputInputs = output.weight.size() / outputs;
  JoinedWeights joined;
  for (size_t n = 0; n < alignUp(outputs, 4); ++n)
    for (uint32_t part = 0; part < kParts; ++part) {
      DoublingSum sum(doubling);
      if (n < outputs) sum.add(output.bias[n]);
      for (uint32_t k = 0; k < channels && n < outputs; ++k) sum.add(output.weight[n * outputInputs + k], k, part);
      sum.appendTo(joined);
    }
  return joined;
}

JoinedWeights joinedAsPatches(ConvWeights doubling, ConvWeights output) {
  const uint32_t channels = channelsBehind(doubling);
  const auto isTap = [](int tap) { return tap >= 0 && tap < 3; };
  JoinedWeights joined;
  for (size_t n = 0; n < output.bias.size(); ++n)
    for (int i = 0; i < kPatch; ++i)
      for (int j = 0; j < kPatch; ++j) {
        DoublingSum sum(doubling);
        const bool inMiddle = (i == 1 || i == 2) && (j == 1 || j == 2);
        if (inMiddle) sum.add(output.bias[n]);
        for (int part = 0; part < static_cast<int>(kParts); ++part) {
          // The tap with which pixel (i - 1, j - 1), counted from the first of the four, sees this one of them.
          const int ky = part / 2 - i + 2, kx = part % 2 - j + 2;
          if (!isTap(ky) || !isTap(kx)) continue;
          for (uint32_t k = 0; k < channels; ++k)
            sum.add(output.weight[(n * channels + k) * kTaps + static_cast<size_t>(3 * ky + kx)], k,
                    static_cast<uint32_t>(part));
        }
        sum.appendTo(joined);
      }
  return joined;
}

}  // namespace xrds
