#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "frames/denoised_frame.h"

namespace xrds {

/// Networks of a denoiser and the upscaler behind them, each ready for its images; as DenoisingParts has them. Null
/// where that has none. They may share an arena.
struct DenoisedRunners {
  std::unique_ptr<FrameRunner> albedo, normal, full, low, upscaler;
  uint32_t guides = 0;
};

/// Frames through a DenoisedFrame: images go to the device once, and the result comes back.
class DenoisedRunner : public FrameRunner {
 public:
  /// shape: of the colour; inputs: the auxiliary images, in their order; exposure: of the upscaler, none: the frame's.
  /// Takes timestamps and the size of submissions from the options. Throws OutOfMemory if the device has no room for
  /// the images.
  DenoisedRunner(Gpu& gpu, DenoisedRunners runners, FrameShape shape, uint32_t scale,
                 const std::vector<std::string>& inputs, std::optional<float> exposure, const SessionOptions& options);

  /// Takes no exposure of the frame, nor layers.
  bool run(const FrameInput& frame, std::span<float> output, const std::function<bool(double)>& progress) override;
  float exposure() const override { return runners_.upscaler->exposure(); }
  const std::vector<uint64_t>& lostPixels() const override { return lostPixels_; }
  std::vector<DispatchTime> times() const override;
  uint64_t byteSize() const override;
  std::vector<FramePart> parts() override { return runners_.upscaler->parts(); }
  const DenoisingParts* denoising() const override { return &parts_; }

  /// Bytes of the images of a frame with so many inputs, of which some are radiance: at most what the runner and a
  /// DenoisedFrame take beside the sessions.
  static uint64_t imageBytes(FrameShape shape, uint32_t scale, const std::vector<std::string>& inputs);

 private:
  void upload(const TensorView& to, const PixelView& image);

  DenoisedRunners runners_;
  DenoisingParts parts_;
  DeviceImages images_;  // what comes and goes
  TensorView colour_, output_;
  std::vector<TensorView> auxiliary_;
  std::optional<DenoisedFrame> frame_;
  std::optional<Recording> recording_;
  std::vector<uint64_t> lostPixels_;
};

}  // namespace xrds
