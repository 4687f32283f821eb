#pragma once

#include <list>
#include <vector>

#include "frames/device_images.h"
#include "frames/session.h"
#include "frames/tiles.h"
#include "shaders/host_pixels/host_pixels.h"
#include "shaders/operators.h"

namespace xrds {

/// Pixels of another program: in its buffer, or all of its image, of which `pixels` tells size and type.
struct HostPicture {
  HostPixels pixels;
  const Buffer* buffer = nullptr;
  const HostImage* image = nullptr;  // in place of the buffer
};

/// An image [h, w, 4] as pixels that sessions take.
HostPicture pictureOf(const DeviceImages& images, const TensorView& image);

/// Dispatches between the pixels of other programs, images of its own and the arenas of sessions, in their order.
class FrameSteps {
 public:
  explicit FrameSteps(Gpu& gpu) : gpu_(gpu), images_(gpu) {}

  /// Images of its own.
  DeviceImages& images() { return images_; }

  /// Where an image is copied to or from: rows without gaps.
  HostPicture inBuffer(const HostPicture& picture);
  /// The picture, or a copy where it is an image.
  HostPicture read(const HostPicture& picture);
  void copy(const ByteRange& from, const ByteRange& to);

  /// Three channels of a part of a picture, which is in a buffer, to a view of an arena that begins at that byte;
  /// `cleared` channels behind them become 0.
  void take(const HostPicture& from, const Rectangle& part, const TensorView& to, const Buffer& arena, uint64_t offset,
            uint32_t channel, uint32_t cleared);
  /// All of a picture to an image of its own [h, w, 4].
  TensorView taken(const HostPicture& from);
  /// Between a buffer, value 0 of the launches, and the bytes of another one from an offset on, value 1.
  void place(std::span<const Dispatch> launches, const Buffer& host, const Buffer& arena, uint64_t offset);
  /// Operators on images of its own.
  void run(std::vector<Operator> operators) { add(images_.placed(std::move(operators))); }
  void add(std::span<const PlacedDispatch> more) { placed_.insert(placed_.end(), more.begin(), more.end()); }

  std::span<const PlacedDispatch> dispatches() const { return placed_; }
  /// Of its own images and copies.
  uint64_t byteSize() const;

 private:
  Gpu& gpu_;
  DeviceImages images_;
  std::list<Buffer> copies_;
  std::vector<PlacedDispatch> placed_;
};

}  // namespace xrds
