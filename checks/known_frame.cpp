#include "checks/known_frame.h"

#include <cmath>
#include <random>

namespace xrds {
namespace {

constexpr float kAnswer[] = {
#include "checks/known_frame_answer.inc"
};
constexpr FrameShape kShape{5, 6};  // less than a window, so that padding counts

// That of xrds-x4-compact, with fewer groups and a smaller scale.
NetworkConfig knownConfig() {
  return {.scale = 2,
          .channels = 32,
          .auxChannels = 16,
          .groups = 1,
          .blocks = 1,
          .window = 8,
          .headChannels = 32,
          .kernels = 5,
          .auxSkip = true,
          .auxKernels = 5};
}

/// Numbers from a uniform distribution in [-1, 1); those of the standard library differ from one to the next.
class Numbers {
 public:
  explicit Numbers(uint32_t seed) : bits_(seed) {}
  float next() { return static_cast<float>(bits_() >> 8) * 0x1p-23F - 1; }

 private:
  std::mt19937 bits_;
};

// Norms near the identity, everything else spread so that the variance of activations stays.
NetworkModel knownModel() {
  Numbers numbers(2023);
  const auto fill = [&](const std::string& name, StoredTensor& tensor) {
    const bool norm = name.find("norm") != std::string::npos;
    const bool matrix = tensor.shape.size() > 1 && name.find("table") == std::string::npos;
    const float fanIn = static_cast<float>(tensor.values.size()) / static_cast<float>(tensor.shape[0]);
    const float spread = matrix ? 1.2F / std::sqrt(fanIn) : 0.2F;
    const float centre = norm && name.ends_with(".weight") ? 1.F : 0.F;
    for (float& value : tensor.values) value = centre + spread * numbers.next();
  };
  return NetworkModel::fromTensors(makeTensors(knownConfig(), fill), "known model");
}

}  // namespace

KnownFrame::KnownFrame() : model_(knownModel()) {
  Numbers numbers(1310);
  const uint32_t scale = model_.config().scale;
  const auto fill = [&](std::vector<float>& image, FrameShape shape, float low, float high) {
    image.resize(size_t{3} * shape.height * shape.width);
    for (float& value : image) value = low + (high - low) * (0.5F + 0.5F * numbers.next());
  };
  fill(colour_, kShape, 0.05F, 3);
  auxiliary_.resize(model_.config().auxInputs.size());
  fill(auxiliary_[0], {scale * kShape.height, scale * kShape.width}, 0.1F, 0.9F);   // albedo
  fill(auxiliary_[1], {scale * kShape.height, scale * kShape.width}, -0.7F, 0.7F);  // normal
}

FrameShape KnownFrame::shape() const { return kShape; }

FrameInput KnownFrame::input() const {
  const uint32_t scale = model_.config().scale;
  FrameInput input{{colour_.data(), kShape.width, kShape.height}};
  for (const auto& image : auxiliary_)
    input.auxiliary.push_back({image.data(), scale * kShape.width, scale * kShape.height});
  return input;
}

std::span<const float> KnownFrame::answer() { return kAnswer; }

}  // namespace xrds
