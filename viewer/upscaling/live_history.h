#pragma once

#include <optional>
#include <vector>

#include "viewer/tracer/path_tracer.h"
#include "xrds/xrds.hpp"

namespace xrds {

/// What a live view has shown, brought to where its camera looks now (TemporalFilter): a view that moves has the light
/// of the pictures before besides its own few samples. With its own it fades out. Used by one thread.
class LiveHistory {
 public:
  /// Images on the host, packed.
  struct Pictures {
    PixelView colour, albedo, normal;
  };

  /// width x height: of the colour. Throws Error if the device has no room.
  LiveHistory(Device& device, uint32_t width, uint32_t height, uint32_t scale);

  /// The camera is about to move: keeps what was shown of the tracer, if it has samples.
  void keep(const PathTracer& tracer, const Camera& camera);

  /// The tracer's pictures merged with what was kept, valid until the next call; nothing where that does not count.
  std::optional<Pictures> merged(const PathTracer& tracer, const Camera& camera);

 private:
  /// Pictures as TemporalFilter takes them, four floats a pixel of the tracer's and three of its own.
  struct Shown {
    std::vector<float> colour{}, albedo{}, normal{}, depth{}, lowCounts{}, fullCounts{};
    uint32_t stride = 3;
    Camera camera{};
  };
  Shown taken(const PathTracer& tracer, const Camera& camera) const;
  TemporalFilter::Frame frameOf(const Shown& shown) const;
  PixelView view(const std::vector<float>& pixels, uint32_t stride, uint32_t scale) const;

  TemporalFilter filter_;
  uint32_t width_, height_, scale_;
  std::optional<Shown> kept_, merged_;
  SampleCounts mergedOf_;  // samples
};

}  // namespace xrds
