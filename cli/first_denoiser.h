#pragma once

#include "app/frame.h"
#include "app/network_denoiser.h"
#include "cli/upscale_options.h"

namespace xrds {

/// Whether --denoise-first runs imported networks on the Vulkan device, which has to be open for it; else it calls the
/// installed library. Throws Failure if networks are asked for that are not there.
bool denoisesOnDevice(const UpscaleOptions& options, const Frame& frame);

/// --denoise-first by the installed library. Throws Failure.
void denoiseByLibrary(const UpscaleOptions& options, Frame& frame);

/// --denoise-first by imported networks, which are read once.
class FirstDenoiser {
 public:
  /// Of many frames networks stay prepared from one to the next, unless --memory is given.
  enum class Frames : uint8_t { one, many };

  /// `progress`: of each network. The options must outlive it.
  FirstDenoiser(const UpscaleOptions& options, Frames frames, const Upscaler::Progress& progress);

  /// denoisesOnDevice() for frames of a sequence.
  bool takes(const Frame& frame);

  /// Throws Error, and Failure when interrupted.
  void denoise(Device& device, Frame& frame);

  /// Of many frames, before the device goes.
  void release() { networks_.release(); }

 private:
  const UpscaleOptions& options_;
  NetworkDenoiser networks_;
};

}  // namespace xrds
