#include "network/halo.h"

#include <algorithm>
#include <vector>

#include "engine/dispatch.h"

namespace xrds {
namespace {

constexpr uint32_t kConv = 1;       // pixels to each side that a 3x3 convolution reads
constexpr uint32_t kFour = 4;       // pixels of a row that are rounded together (Conv3x3::inFours)
constexpr uint32_t kBaseReads = 2;  // low-resolution pixels to each side that the base images read

/// The forward pass on distances: each value is the first pixel, counted from the edge of a crop, at which a tensor
/// equals the whole frame's, in pixels of that tensor. A window is exact if all its pixels are.
class Reach {
 public:
  explicit Reach(const NetworkConfig& config) : config_(config) {}

  uint32_t output() const {
    uint32_t network = 0, x = 0;
    if (config_.groups > 0) {
      network = upscaled(lowResolution(deshuffled()));
      if (config_.auxSkip) network = std::max(network, auxFeatures(config_.groups));
      if (config_.outputSide == 3) network = convInFours(network);
    }
    if (config_.auxKernels > 0) {
      const uint32_t filtered = std::max(network, config_.auxKernels / 2);
      x = ceilDivide(filtered, config_.scale);
      network = filtered;
    }
    const bool baseReads = config_.base != BaseImage::none;
    return std::max(network, baseReads ? (x + kBaseReads) * config_.scale : 0);
  }

 private:
  uint32_t convInFours(uint32_t reach) const {
    return config_.mayRoundInFours() ? alignUp(reach + kConv, kFour) : reach + kConv;
  }

  // H_i: one convolution, then two in each block.
  uint32_t auxFeatures(uint32_t i) const {
    uint32_t reach = 0;
    for (uint32_t conv = 0; conv < 1 + 2 * i; ++conv) reach = convInFours(reach);
    return reach;
  }

  // D_i, at low resolution.
  std::vector<uint32_t> deshuffled() const {
    std::vector<uint32_t> d;
    for (uint32_t i = 0; i <= config_.groups && !config_.auxInputs.empty(); ++i) {
      uint32_t reach = auxFeatures(i);
      for (uint32_t step = 0; step < config_.steps(); ++step) reach = convInFours(ceilDivide(reach, 2));
      d.push_back(config_.steps() == 0 ? convInFours(reach) : reach);
    }
    return d;
  }

  uint32_t attention(uint32_t reach, bool shifted) const {
    const uint32_t shift = shifted ? config_.window / 2 : 0;
    return reach <= shift ? shift : alignUp(reach - shift, config_.window) + shift;
  }

  // F_N, then fuse and body_conv.
  uint32_t lowResolution(const std::vector<uint32_t>& d) const {
    uint32_t f = kConv;
    for (uint32_t g = 0; g < config_.groups; ++g) {
      f += kConv;
      if (!d.empty()) f = std::max(f, d[g] + kConv);
      if (config_.cross == CrossKind::attention) f = attention(f, false);
      for (uint32_t b = 0; b < config_.blocks; ++b) f = block(f, b);
      f += kConv;
    }
    if (!d.empty()) f = std::max(f, d.back());
    return f + 2 * kConv;
  }

  uint32_t block(uint32_t reach, uint32_t b) const {
    if (config_.block == BlockKind::rdb) return reach + 3 * kConv;
    for (uint32_t k = 0; k < 3; ++k) reach = attention(reach, (3 * b + k) % 2 == 1);
    return reach + kConv;
  }

  // up_pre and the doublings, at high resolution.
  uint32_t upscaled(uint32_t reach) const {
    reach += kConv;
    for (uint32_t step = 0; step < config_.steps(); ++step) reach = 2 * convInFours(reach);
    return reach;
  }

  const NetworkConfig& config_;
};

}  // namespace

uint32_t exactHalo(const NetworkConfig& config) {
  const uint32_t output = Reach(config).output();
  return alignUp(ceilDivide(output, config.scale), config.window);
}

uint32_t boundedHalo(const NetworkConfig& config) { return std::min(2 * config.window, exactHalo(config)); }

}  // namespace xrds
