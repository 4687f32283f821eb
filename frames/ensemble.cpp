#include "frames/ensemble.h"

#include <algorithm>
#include <cmath>

#include "xrds/auxiliary_input.h"

namespace xrds {
namespace {

bool isDirection(const std::string& input) {
  const AuxiliaryInput* known = findAuxiliaryInput(input);
  return known && known->isDirection;
}

}  // namespace

MirroredFrame::MirroredFrame(const PixelView& colour, std::span<const PixelView> auxiliary,
                             std::span<const std::string> inputs, Mirror mirror) {
  const auto add = [&](const PixelView& image, bool isNormal) {
    pixels_.push_back(mirrored(image, mirror, isNormal));
    const bool turned = mirror.transposed;
    views_.push_back({pixels_.back().data(), turned ? image.height : image.width, turned ? image.width : image.height});
  };
  add(colour, false);
  for (size_t i = 0; i < auxiliary.size(); ++i) add(auxiliary[i], isDirection(inputs[i]));
}

MirroredLayers::MirroredLayers(std::span<const LayerImage> layers, Mirror mirror, uint32_t scale)
    : mirror_(mirror), scale_(scale) {
  for (const LayerImage& layer : layers) {
    width_ = mirror.transposed ? layer.image.height : layer.image.width;
    height_ = mirror.transposed ? layer.image.width : layer.image.height;
    pixels_.push_back(mirrored(layer.image, mirror, false));
    means_.emplace_back(layer.mean.size());
  }
}

std::vector<LayerImage> MirroredLayers::images() {
  std::vector<LayerImage> images;
  for (size_t i = 0; i < pixels_.size(); ++i) images.push_back({{pixels_[i].data(), width_, height_}, means_[i]});
  return images;
}

void MirroredLayers::add(std::span<const LayerImage> layers, float share) const {
  for (size_t i = 0; i < layers.size(); ++i)
    for (uint64_t p = 0; p < means_[i].size() / 3; ++p) {
      float* to = &layers[i].mean[3 * mirroredPixel(p, scale_ * width_, scale_ * height_, mirror_)];
      for (uint32_t c = 0; c < 3; ++c) to[c] += share * means_[i][3 * p + c];
    }
}

EnsembleMean::EnsembleMean(uint32_t width, uint32_t height, Transfer transfer)
    : width_(width), height_(height), transfer_(transfer), sum_(size_t{3} * width * height) {}

void EnsembleMean::add(std::span<const float> result, Mirror mirror, float exposure) {
  const uint32_t width = mirror.transposed ? height_ : width_, height = mirror.transposed ? width_ : height_;
  for (uint64_t p = 0; p < sum_.size() / 3; ++p) {
    const float* from = &result[3 * p];
    float* to = &sum_[3 * mirroredPixel(p, width, height, mirror)];
    for (uint32_t c = 0; c < 3; ++c)
      to[c] += transfer_ == Transfer::log1p ? std::log1p(std::max(0.f, exposure * from[c])) : from[c];
  }
  ++count_;
}

void EnsembleMean::write(std::span<float> output, float exposure) const {
  const float share = 1 / static_cast<float>(count_);
  for (size_t i = 0; i < sum_.size(); ++i) {
    const float mean = sum_[i] * share;
    output[i] = transfer_ == Transfer::log1p ? std::expm1(mean) / exposure : mean;
  }
}

}  // namespace xrds
