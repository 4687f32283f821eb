#include "checks/stress/parts.h"

#include <algorithm>
#include <cmath>

#include "network/halo.h"
#include "xrds/skip.h"

namespace xrds {

FrameShape partedFrame(const NetworkConfig& config) {
  const uint32_t halo = seesWholeFrame(config) ? boundedHalo(config) : exactHalo(config);
  return {config.window + 3, 2 * halo + 2 * config.window + 3};
}

PartRunner::PartRunner(Gpu& gpu, const NetworkModel& model, Precision precision, Parts parts)
    : parts_(parts), config_(model.config()), shape_(partedFrame(config_)) {
  const SessionOptions options{.precision = precision};
  if (parts == Parts::skip) {
    const uint32_t halo = std::min(config_.window, exactHalo(config_));
    sparse_.emplace(gpu, model, options, cutFrame(shape_, config_.window, {}),
                    SparseOptions{.bound = kSafeSkip, .halo = halo});
    return;
  }
  const uint32_t halo = parts == Parts::exactTiles ? exactHalo(config_) : boundedHalo(config_);
  tiles_ = cutFrame(shape_, config_.window, {2, 1, halo});
  XRDS_CHECK_EQ(tiles_.size(), 2u);
  tiled_.emplace(gpu, model, options);
}

void PartRunner::run(const StressFrame& frame, bool autoExposure, std::span<float> output) {
  const FrameInput input = frame.input(autoExposure);
  if (sparse_)
    sparse_->run(input, output);
  else
    tiled_->run(input, tiles_, output);
}

double PartRunner::largestSkippedChange(std::span<const float> output, std::span<const float> whole) const {
  const WindowMask& skipped = sparse_->interpolated();
  const uint32_t side = config_.window * config_.scale, width = shape_.width * config_.scale;
  std::vector<double> squares(skipped.marks.size()), counts(skipped.marks.size());
  const auto encoded = [&](float radiance) {
    return std::log1p(double{sparse_->exposure()} * std::max(radiance, 0.f));
  };
  for (size_t i = 0; i < output.size(); ++i) {
    const size_t window = i / 3 / width / side * skipped.columns + i / 3 % width / side;
    squares[window] += std::pow(encoded(output[i]) - encoded(whole[i]), 2);
    ++counts[window];
  }
  double largest = 0;
  for (size_t w = 0; w < squares.size(); ++w)
    if (skipped.marks[w]) largest = std::max(largest, std::sqrt(squares[w] / counts[w]));
  return largest;
}

}  // namespace xrds
