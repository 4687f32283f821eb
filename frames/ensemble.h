#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "frames/frame_input.h"
#include "shaders/common/transfer.h"
#include "xrds/mirror.h"
#include "xrds/pixel_view.h"

namespace xrds {

/// A frame mirrored: copies of its images.
class MirroredFrame {
 public:
  /// `inputs` names the auxiliary images; "normal" is one whose components turn along.
  MirroredFrame(const PixelView& colour, std::span<const PixelView> auxiliary, std::span<const std::string> inputs,
                Mirror mirror);
  const PixelView& colour() const { return views_.front(); }
  std::span<const PixelView> auxiliary() const { return std::span(views_).subspan(1); }

 private:
  std::vector<std::vector<float>> pixels_;
  std::vector<PixelView> views_;
};

/// Layers mirrored as a frame is, and what a pass makes of them.
class MirroredLayers {
 public:
  MirroredLayers(std::span<const LayerImage> layers, Mirror mirror, uint32_t scale);
  std::vector<LayerImage> images();
  /// Adds `share` of what the pass made to the means of the layers as they were given.
  void add(std::span<const LayerImage> layers, float share) const;

 private:
  Mirror mirror_;
  std::vector<std::vector<float>> pixels_, means_;
  uint32_t scale_, width_ = 0, height_ = 0;  // of a mirrored layer
};

/// The mean of the results of all passes, in the domain of the network: T^-1(mean T(e I)) / e, so that a pixel far too
/// bright in one pass weighs little. (Geometric self-ensemble: Timofte, Rothe & Van Gool 2016, section 3.)
class EnsembleMean {
 public:
  /// width x height: of the mean.
  EnsembleMean(uint32_t width, uint32_t height, Transfer transfer);
  /// Adds the result of a mirrored frame, three floats a pixel, at its exposure.
  void add(std::span<const float> result, Mirror mirror, float exposure);
  /// Writes the mean of what was added, at that exposure.
  void write(std::span<float> output, float exposure) const;

 private:
  uint32_t width_, height_, count_ = 0;
  Transfer transfer_;
  std::vector<float> sum_;
};

}  // namespace xrds
