#pragma once

#include <optional>

#include "frames/frame_steps.h"

namespace xrds {

/// A part of a frame, and the session that makes it; those of a frame may share an arena, so that they go in order.
struct FramePart {
  const Session* session = nullptr;
  Tile tile;
};

/// The images of a frame, as another program holds them, and how the frame is exposed.
struct HostPictures {
  HostPicture colour;                  // [h, w]
  std::vector<HostPicture> auxiliary;  // [s h, s w] each, in the model's order
  HostPicture output;                  // [s h, s w]
  HostPicture alpha;                   // [h, w], for the parts of an alpha
  /// The exposure: of one float of a buffer, which is read with each frame; else given; else as the frame's mean
  /// luminance has it, or the bins of it where the model takes that.
  const Buffer* exposureBuffer = nullptr;
  uint64_t exposureOffset = 0;
  std::optional<float> exposure{};
  bool binnedExposure = false;
  bool marksLost = false;  // the output's fourth channel is not 1, but as Session::downloadRows() has it
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

  std::span<const PlacedDispatch> dispatches() const { return steps_.dispatches(); }
  /// Device memory of its own, beside that of the sessions.
  uint64_t byteSize() const { return steps_.byteSize(); }

 private:
  const Buffer* prepareExposure(std::span<const FramePart> parts, const HostPictures& pictures);
  void addParts(std::span<const FramePart> parts, const HostPictures& pictures);
  void addPart(const FramePart& part, const HostPictures& pictures, const Buffer* exposure);

  Gpu& gpu_;
  FrameSteps steps_;
};

}  // namespace xrds
