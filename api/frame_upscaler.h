#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "api/denoising.h"
#include "frames/host_frame.h"
#include "network/network_model.h"
#include "xrds/stress.h"

namespace xrds {

/// Upscaler of the public API, which documents what the functions do, on the engine's device and the network's model.
class FrameUpscaler {
 public:
  using Options = Upscaler::Options;
  using Progress = Upscaler::Progress;

  /// Device and models must outlive it.
  FrameUpscaler(Gpu& gpu, const NetworkModel& model, FrameShape shape, const Options& options,
                const DenoisingModels& denoising = {});
  ~FrameUpscaler();
  FrameUpscaler(const FrameUpscaler&) = delete;
  FrameUpscaler& operator=(const FrameUpscaler&) = delete;

  bool run(const PixelView& colour, std::span<const PixelView> auxiliary, std::span<float> output,
           std::span<const LayerSet> layers, const Progress& progress = {});
  const std::vector<LayerReport>& layerReports() const;
  Upscaler::Repairs repairs() const;
  float exposure() const;
  uint64_t deviceBytes() const;
  const Tiling& tiling() const;
  SkipMap skipMap() const;
  std::vector<Upscaler::ProfileRow> profile() const;

  Gpu& gpu() const;
  const Options& options() const;
  const NetworkConfig& config() const;
  FrameShape shape() const;  // of the low-resolution colour
  /// What a frame is made of. Throws InvalidArgument where that depends on its pixels, or it takes several passes.
  std::vector<FramePart> parts() const;
  /// While a copy lives, the parts stay as they are: layers, which would change them, are refused.
  std::shared_ptr<const void> hold() const;
  /// What stands in front of it; null: no denoiser.
  const DenoisingParts* denoising() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Upscaler::paysToTune, ::check and ::stress.
bool paysToTune(const Gpu& gpu, const NetworkModel& model, FrameShape frame, bool fp16);
std::vector<Upscaler::CheckRow> checkFrame(Gpu& gpu, const NetworkModel& model, const PixelView& colour,
                                           std::span<const PixelView> auxiliary, const Upscaler::Options& options,
                                           const DenoisingModels& denoising);

std::vector<Upscaler::ProfileRow> profileRows(std::span<const DispatchTime> times);

/// An alpha upscaled by a FrameUpscaler of the model without a network, in [0, 1]: what is 0 or 1 all around stays
/// exactly that. Throws Error as it does.
std::vector<float> upscaledAlpha(FrameUpscaler& bicubic, std::span<const float> alpha);

}  // namespace xrds
