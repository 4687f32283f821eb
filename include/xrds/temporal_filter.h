#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "xrds/device.h"
#include "xrds/image_call.h"
#include "xrds/pixel_view.h"

namespace xrds {

/// Makes the inputs of frames of an animation stable over time: the images of a frame, merged with those of the frames
/// around it, which are brought to where it shows the same and count as far as they agree. What an Upscaler makes of
/// them flickers less and has less noise, as if the frame had more samples.
class TemporalFilter {
 public:
  /// A frame to merge. Images that are not there have no pixels; every frame has the same ones. Pixels of images that
  /// are not finite are filled from their neighbours.
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
    std::vector<float> colour{}, fullColour{}, albedo{}, normal{}, lowCounts{}, fullCounts{};
  };

  /// Frames before and after that are worth it, and while most of the picture stands still.
  static constexpr uint32_t kRadius = 5, kRadiusOfStill = 10;

  /// width x height: of the low-resolution colour. The device must outlive it. Throws InvalidArgument if the scale is
  /// none of 1, 2, 4, 8 and 16 or there is no frame of that size; OutOfMemory if the device has no room.
  TemporalFilter(Device& device, uint32_t width, uint32_t height, uint32_t scale);

  /// The frame merged with those before and after it, in order, the nearest first. The result depends on these frames
  /// alone, not on earlier runs. For live pictures `before` is the last result alone, with its counts. Throws
  /// InvalidArgument if a size does not fit, Error if the device fails.
  Merged run(const Frame& present, std::span<const Frame> before, std::span<const Frame> after = {});

  /// Device memory in use.
  uint64_t deviceBytes() const { return xrdsGetTemporalDeviceBytes(handle()); }

  /// For the functions of the C API; valid as long as the filter lives.
  XrdsTemporalFilter* handle() const { return handle_.get(); }

 private:
  struct Size {
    uint32_t width = 0, height = 0;
    size_t pixels() const { return size_t{width} * height; }
  };
  static const float* numbers(const char* name, std::span<const float> given, size_t expected);
  static XrdsImage place(std::vector<float>& pixels, Size size);
  XrdsTemporalFrame given(const Frame& frame) const;

  Size low_, full_;
  call::Owned<XrdsTemporalFilter> handle_;
};

inline TemporalFilter::TemporalFilter(Device& device, uint32_t width, uint32_t height, uint32_t scale)
    : low_{width, height}, full_{scale * width, scale * height} {
  XrdsTemporalFilter* made = nullptr;
  const XrdsResult result = xrdsCreateTemporalFilter(device.handle(), width, height, scale, &made);
  handle_.reset(made);
  device.finish(result);
}

inline const float* TemporalFilter::numbers(const char* name, std::span<const float> given, size_t expected) {
  if (given.empty()) return nullptr;
  if (given.size() != expected)
    throw InvalidArgument("The " + std::string(name) + " of a frame to merge has " + std::to_string(given.size()) +
                          " numbers, expected " + std::to_string(expected) + ".");
  return given.data();
}

inline XrdsTemporalFrame TemporalFilter::given(const Frame& frame) const {
  XrdsTemporalFrame given = xrdsTemporalFrameDefault();
  given.colour = call::image(frame.colour, "colour");
  given.fullColour = call::image(frame.fullColour, "full-resolution colour");
  given.albedo = call::image(frame.albedo, "albedo");
  given.normal = call::image(frame.normal, "normal");
  given.depth = numbers("depth", frame.depth, full_.pixels());
  given.toPrevious = numbers("motion to the previous frame", frame.toPrevious, 2 * full_.pixels());
  given.toNext = numbers("motion to the next frame", frame.toNext, 2 * full_.pixels());
  // Which the library only reads here.
  given.lowCounts = const_cast<float*>(numbers("low-resolution counts", frame.lowCounts, low_.pixels()));
  given.fullCounts = const_cast<float*>(numbers("full-resolution counts", frame.fullCounts, full_.pixels()));
  return given;
}

inline XrdsImage TemporalFilter::place(std::vector<float>& pixels, Size size) {
  pixels.resize(3 * size.pixels());
  return call::image(pixels, size.width, size.height);
}

inline TemporalFilter::Merged TemporalFilter::run(const Frame& present, std::span<const Frame> before,
                                                  std::span<const Frame> after) {
  const XrdsTemporalFrame now = given(present);
  std::vector<XrdsTemporalFrame> past, future;
  for (const Frame& frame : before) past.push_back(given(frame));
  for (const Frame& frame : after) future.push_back(given(frame));
  Merged merged{.lowCounts = std::vector<float>(low_.pixels()), .fullCounts = std::vector<float>(full_.pixels())};
  XrdsTemporalFrame result = xrdsTemporalFrameDefault();
  result.colour = place(merged.colour, low_);
  if (present.fullColour.pixels) result.fullColour = place(merged.fullColour, full_);
  if (present.albedo.pixels) result.albedo = place(merged.albedo, full_);
  if (present.normal.pixels) result.normal = place(merged.normal, full_);
  result.lowCounts = merged.lowCounts.data();
  result.fullCounts = merged.fullCounts.data();
  call::check(xrdsMergeFrames(handle(), &now, past.data(), static_cast<uint32_t>(past.size()), future.data(),
                              static_cast<uint32_t>(future.size()), &result));
  return merged;
}

}  // namespace xrds
