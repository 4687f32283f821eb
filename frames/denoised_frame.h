#pragma once

#include <list>
#include <span>
#include <string>

#include "frames/frame_runner.h"

namespace xrds {

/// Networks of a denoiser in front of an upscaler, each ready for its images.
struct DenoisingParts {
  std::vector<FramePart> albedo, normal;  // none: these have no noise
  std::vector<FramePart> full;            // of full-resolution radiance; none: the upscaler takes none
  std::vector<FramePart> low;             // of the colour
  uint32_t guides = 0;                    // that `full` and `low` take: none, albedo, albedo and normal
};

/// A frame through a denoiser and an upscaler as dispatches, between which nothing passes the host: albedo and normal
/// are denoised, each by itself; radiance at their resolution, with them; the colour, with their box means; and all is
/// upscaled. What an albedo has above 1 stays as it is.
class DenoisedFrame {
 public:
  /// inputs: what pictures.auxiliary are, in their order; a full-resolution colour is at the level of the other one
  /// (levelledColour()). As HostFrame else. Throws Error if the device cannot bind an image.
  DenoisedFrame(Gpu& gpu, const DenoisingParts& denoising, std::span<const FramePart> upscaling,
                std::span<const std::string> inputs, const HostPictures& pictures,
                std::span<const FramePart> alphaParts = {});

  std::span<const PlacedDispatch> dispatches() const { return steps_.dispatches(); }
  /// Device memory of its own, beside that of the sessions.
  uint64_t byteSize() const;

 private:
  TensorView cleanAlbedo(std::span<const FramePart> parts, const HostPicture& albedo);
  TensorView denoised(std::span<const FramePart> parts, const HostPicture& picture, std::span<const HostPicture> guides,
                      bool isRadiance);
  void add(std::span<const FramePart> parts, const HostPictures& pictures, std::span<const FramePart> alphaParts = {});

  Gpu& gpu_;
  FrameSteps steps_;
  std::list<HostFrame> frames_;
};

}  // namespace xrds
