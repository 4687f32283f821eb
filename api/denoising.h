#pragma once

#include "api/frame_plan.h"

namespace xrds {

/// The networks of Upscaler::Options::denoisers.
struct DenoisingModels {
  const NetworkModel *colour = nullptr, *albedo = nullptr, *normal = nullptr;
  explicit operator bool() const { return colour || albedo || normal; }
};

/// Throws InvalidArgument if the models do not denoise what the upscaler takes.
void checkDenoising(const NetworkConfig& upscaler, const DenoisingModels& models);

/// Whether the options exclude denoisers that stand in front of the upscaler on the device, so that they run one after
/// the other (SeparateDenoisers).
bool runsSeparately(const Upscaler::Options& options);

/// Throws Error if the memory that the options allow has no room for the smallest tiles of each network by itself.
void checkRoomForEach(const Gpu& gpu, const NetworkConfig& upscaler, FrameShape frame, const DenoisingModels& models,
                      const Upscaler::Options& options);

/// A frame made ready with a denoiser in front.
struct DenoisedPlan {
  std::unique_ptr<FrameRunner> runner;
  Tiling tiling;  // of the upscaler
};

/// Makes all networks of a frame ready in so much memory, with one arena for all. `of`: options of the upscaler's
/// sessions. Throws Error if they do not fit.
DenoisedPlan planDenoised(Gpu& gpu, const NetworkModel& model, FrameShape frame, const DenoisingModels& denoising,
                          const Upscaler::Options& options, const SessionOptions& of, uint64_t memory);

}  // namespace xrds
