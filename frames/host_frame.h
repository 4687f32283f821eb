#pragma once

#include <list>
#include <optional>

#include "frames/session.h"
#include "frames/tiles.h"
#include "shaders/host_pixels/host_pixels.h"

namespace xrds {

/// A part of a frame, and the session that makes it; those of a frame may share an arena, so that they go in order.
struct FramePart {
  const Session* session = nullptr;
  Tile tile;
};

/// Pixels of another program: in its buffer, or all of its image, of which `pixels` tells size and type.
struct HostPicture {
  HostPixels pixels;
  const Buffer* buffer = nullptr;
  const HostImage* image = nullptr;  // in place of the buffer
};

struct HostPictures {
  HostPicture colour;                  // [h, w]
  std::vector<HostPicture> auxiliary;  // [s h, s w] each, in the model's order
  HostPicture output;                  // [s h, s w]
  HostPicture alpha;                   // [h, w], for the parts of an alpha
  /// The exposure: of one float of a buffer, which is read with each frame; else given; else as the frame's mean
  /// luminance has it.
  const Buffer* exposureBuffer = nullptr;
  uint64_t exposureOffset = 0;
  std::optional<float> exposure{};
};

/// A frame as dispatches from another program's pixels to its pixels, none of which passes the host: ready to be
/// recorded into its command buffers.
class HostFrame {
 public:
  /// The sessions and buffers must outlive it. alphaParts: of the model without a network, which make the output's
  /// fourth channel; none: it is 1. Sizes, and that sessions compute exposures where none is given, are the caller's to
  /// check. Throws OutOfMemory if the device has no room for copies of images.
  HostFrame(Gpu& gpu, std::span<const FramePart> parts, const HostPictures& pictures,
            std::span<const FramePart> alphaParts = {});

  std::span<const PlacedDispatch> dispatches() const { return placed_; }

 private:
  const Buffer& ownBuffer(uint64_t byteSize);
  HostPicture inBuffer(const HostPicture& picture);
  void take(const HostPicture& from, const Rectangle& part, const TensorView& to, const Buffer& graph, uint64_t offset,
            uint32_t channel = 0, uint32_t cleared = 0);
  const Buffer* prepareExposure(std::span<const FramePart> parts, const HostPictures& pictures);
  void addParts(std::span<const FramePart> parts, const HostPictures& pictures);
  void addPart(const FramePart& part, const HostPictures& pictures, const Buffer* exposure);
  void copy(const ByteRange& from, const ByteRange& to);
  void place(std::span<const Dispatch> dispatches, const Buffer& host, const Buffer& graph, uint64_t graphOffset);

  Gpu& gpu_;
  std::list<Buffer> own_;
  std::vector<PlacedDispatch> placed_;
};

}  // namespace xrds
