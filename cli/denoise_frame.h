#pragma once

#include <string>

#include "app/frame.h"
#include "app/network_denoiser.h"
#include "cli/upscale_options.h"

namespace xrds {

/// What `xrds denoise` was asked for.
struct DenoiseOptions {
  UpscaleOptions common{.tiles = "exact", .auxColour = "never", .tune = "never"};  // what it has in common with upscale
  std::string guides = "prefilter", quality = "high";
  bool ldr = false;
};

/// The headers of a frame, with the images beside the colour that its files have and that are wanted. Throws Error, as
/// where they are of another size.
Frame openFrame(const DenoiseOptions& options, const std::string& color, const std::string& aux);

NetworkDenoiser::Options networksOf(const DenoiseOptions& options, const std::function<bool(double)>& progress);

/// Whether the guides have no noise, and whether so many of them are denoised before.
bool areClean(const DenoiseOptions& options);
bool arePrefiltered(const DenoiseOptions& options, size_t guides);

/// What became of a frame, its layers in the order of FrameLayers.
struct Denoised {
  Image picture;
  UpscaledLayers layers{};
};

/// That of a frame that was read: its picture, and its layers, each without its noise and with its share of the
/// picture. Throws Error, and Failure when interrupted.
Denoised denoised(NetworkDenoiser& networks, Device& device, const Frame& frame, const DenoiseOptions& options);

/// How many images go through networks for that.
size_t runsFor(const Frame& frame, const DenoiseOptions& options);

/// What the file of a result says beside its pixels.
ExrOutput outputOf(const DenoiseOptions& options, const Frame& frame, const std::string& denoiser);

}  // namespace xrds
