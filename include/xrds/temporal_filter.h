#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "xrds/device.h"
#include "xrds/export.h"
#include "xrds/pixel_view.h"

namespace xrds {

/// Makes the inputs of frames of an animation stable over time: the images of a frame, merged with those of the frames
/// around it, which are brought to where it shows the same and count as far as they agree. What an Upscaler makes of
/// them flickers less and has less noise, as if the frame had more samples.
class XRDS_API TemporalFilter {
 public:
  /// A frame to merge. Images that are not there have no pixels; every frame has the same ones.
  struct Frame {
    PixelView colour;                        // [h, w] linear radiance
    PixelView fullColour, albedo, normal{};  // [s h, s w]; radiance, and the guides that tell surfaces apart
    std::span<const float> depth{};          // [s h, s w] distances in any unit; at least 1e8, 0 or less: background
    /// Pixels of the full resolution from what a pixel shows to where the frame before and the one after it show that:
    /// x to the right, y down, [s h, s w, 2]. Where one is empty, frames of that side cannot be used. What is not
    /// finite counts as gone.
    std::span<const float> toPrevious{}, toNext{};
    /// How many frames each pixel is the mean of, as Merged has it; empty: one.
    std::span<const float> lowCounts{}, fullCounts{};
  };

  /// The images of a frame, three floats a pixel, merged; empty those that it lacks. Counts: how many frames a pixel of
  /// the two radiances is the mean of.
  struct Merged {
    std::vector<float> colour, fullColour, albedo, normal, lowCounts, fullCounts;
  };

  static constexpr uint32_t kRadius = 5;  // frames before and after that are worth it

  /// width x height: of the low-resolution colour. The device must outlive it. Throws InvalidArgument if the scale is
  /// none of 1, 2, 4, 8 and 16 or there is no frame of that size; OutOfMemory if the device has no room.
  TemporalFilter(Device& device, uint32_t width, uint32_t height, uint32_t scale);
  ~TemporalFilter();
  TemporalFilter(TemporalFilter&&) noexcept;
  TemporalFilter& operator=(TemporalFilter&&) noexcept;

  /// The frame merged with those before and after it, in order, the nearest first. The result depends on these frames
  /// alone, not on earlier runs. For live pictures `before` is the last result alone, with its counts. Throws
  /// InvalidArgument if a size does not fit, Error if the device fails.
  Merged run(const Frame& present, std::span<const Frame> before, std::span<const Frame> after = {});

  /// Device memory in use.
  uint64_t deviceBytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace xrds
