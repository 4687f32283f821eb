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

  /// Whether the upscaler has the networks in front of it, so that no image comes back in between where the device has
  /// room for that. Not where more is asked of the frame than one pass over all of it, or where --memory is for each
  /// network alone.
  bool goesAlong(const Frame& frame);

  /// Makes the upscaler of a frame with which the networks go along, with them in front. Throws Error. The upscaler
  /// must go before this.
  void prepare(std::optional<Upscaler>& upscaler, Device& device, const Model& model, const Frame& frame);

  /// What is left to do before the upscaler: nothing but the levels of the frame if the networks go along with it, else
  /// all of it. Throws Error, and Failure when interrupted.
  void denoise(Device& device, Frame& frame);

  /// Of the networks that denoise() ran: seconds with upload and download, and the most device memory in bytes.
  double seconds() const { return networks_.runSeconds(); }
  uint64_t deviceBytes() const { return networks_.deviceBytes(); }

  /// Of many frames, before the device goes.
  void release() { networks_.release(); }

 private:
  const UpscaleOptions& options_;
  NetworkDenoiser networks_;
};

}  // namespace xrds
