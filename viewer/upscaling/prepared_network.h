#pragma once

#include <functional>
#include <string>

#include "viewer/frame_files.h"
#include "viewer/pictures.h"
#include "viewer/vulkan/buffer.h"

namespace xrds {

/// What a network must be made ready for: the size of the colour, and the auxiliary images that there are.
struct FrameSize {
  uint32_t width = 0, height = 0;
  int scale = 0;  // 0: any
  std::vector<std::string> inputs;
  bool has(const std::string& input) const;
};

/// How a network runs.
struct NetworkOptions {
  bool fp16 = false;
  std::optional<float> exposure{};  // empty: from the colour
  uint32_t ensemble = 1;            // passes, of which the frame goes through the host
  bool wrap = false;                // as TileOptions has it
  SkipOptions skip{};
  Upscaler::Denoisers denoisers{};  // of all images before the network; they must outlive what they are given to
  bool exactTiles = false;          // as TileOptions has it
  uint64_t memoryBytes = 0;         // of the device; 0: most of it. What does not fit is computed in tiles.
  Upscaler::Tune tune = Upscaler::Tune::automatic;
  std::function<bool(double)> onTuning{};  // as Upscaler::Options has it
  /// Of a submission, which a drawing may have to wait for; at first for a CPU to finish one in about 10 ms.
  uint64_t multiplyAddsAtOnce = uint64_t{1} << 26;
};
/// Whether they give the same picture.
bool operator==(const NetworkOptions& a, const NetworkOptions& b);

/// A model on a device, ready for frames of one size. The frame stays on the device where it is computed as a whole;
/// in tiles or with windows left out it passes through the host.
class PreparedNetwork {
 public:
  /// Throws Failure if the model does not fit the frame, Error if the device cannot hold it, Cancelled if `onTuning`
  /// says so.
  PreparedNetwork(VulkanDevice& vulkan, Device& device, std::string name, Model model, const FrameSize& frame,
                  const NetworkOptions& options);

  const std::string& name() const { return name_; }
  const NetworkOptions& options() const { return options_; }
  const Model& model() const { return model_; }
  bool fits(const FrameSize& frame) const;
  const Upscaler& upscaler() const { return upscaler_; }
  bool isOnDevice() const { return recording_.has_value(); }
  uint32_t tileCount() const { return upscaler_.tiling().columns * upscaler_.tiling().rows; }

  /// Gives it the frame's images: from the host, where they stay in use until another frame is given; or from buffers
  /// on the device that hold [height, width, 4] floats of colour and [scale height, 2, scale width, 4] of albedo and
  /// normal.
  void take(const LoadedFrame& frame);
  void take(const DeviceBuffer& colour, const DeviceBuffer& auxiliary);
  /// Gives it the images of a live view from the host, where they stay in use until others are given.
  void takeLive(const PixelView& colour, const PixelView& albedo, const PixelView& normal);
  /// Makes the inputs pictures to look at.
  void showInputs(Pictures& pictures) const;
  /// Returns false if `progress` stopped it.
  bool run(const Upscaler::Progress& progress);
  /// Of a run in tiles that is under way or was stopped, those that are finished over what was there before.
  void showOutput(Pictures& pictures, Slot slot) const;
  void showSkipMap(Pictures& pictures) const;
  /// A copy of the output for the host.
  Image download() const;
  /// Of the last run.
  std::vector<Upscaler::ProfileRow> profile() const;
  float exposure() const;
  uint64_t deviceBytes() const;
  /// How large submissions should be, by the time that the last run took, for each to take about 10 ms: as they are
  /// where that run kept windows of the one before.
  uint64_t paceFor(double runMilliseconds) const;

 private:
  void requireLiveInputs() const;
  void take(const PixelView& colour, std::vector<PixelView> auxiliary);
  void record();
  void fillOutput();

  VulkanDevice& vulkan_;
  std::string name_;
  Model model_;
  NetworkOptions options_;
  uint32_t width_, height_;
  Upscaler upscaler_;
  // Of a frame that stays on the device: its images there, those beside the colour as planes of one.
  std::unique_ptr<DeviceBuffer> deviceColour_, deviceAuxiliary_, deviceOutput_;
  std::optional<FrameRecording> recording_;
  // Of a frame that passes through the host.
  std::vector<float> copiedColour_, output_;
  std::vector<std::vector<float>> copiedAuxiliary_;
  std::vector<float> levelledFull_;  // a frame's full-resolution colour, as denoisers take it
  PixelView colour_;
  std::vector<PixelView> auxiliary_;
};

}  // namespace xrds
