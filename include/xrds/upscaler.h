#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "xrds/device.h"
#include "xrds/layers.h"
#include "xrds/model.h"
#include "xrds/pixel_view.h"
#include "xrds/precision.h"
#include "xrds/skip.h"
#include "xrds/tiling.h"

namespace xrds {

struct StressOptions;
struct StressReport;

/// A model made ready for one frame size on one device: planned and recorded once, replayed for each frame. A frame
/// that does not fit the device's memory or limits is cut into tiles.
class Upscaler {
 public:
  /// Whether an upscaler tunes the device's kernels for its frame where that was not done (xrds/tuning.h): never; by
  /// itself where paysToTune() says so; or now. What an earlier tuning found is used in any case, unless a kernel
  /// family was asked for; an upscaler that need not tune does not wait for it.
  enum class Tune : uint8_t { never, automatic, now };

  /// Networks of Open Image Denoise (xrds/oidn_import.h) that take the noise out of the images before they are
  /// upscaled: out of albedo and normal, unless they have no noise, each by its own; then light at their resolution,
  /// with these; then the colour, with their box means. Their exposure is their own. Between them nothing leaves the
  /// device; but with an ensemble (its passes are theirs, too), SkipOptions, TileOptions::wrap, layers, or where they
  /// find no room together, they run one after the other. Then they cannot be recorded.
  struct Denoisers {
    const Model* colour = nullptr;  // HDR, with as many guides as the model has of albedo and normal, or fewer
    const Model* albedo = nullptr;  // null: the albedo has no noise
    const Model* normal = nullptr;
    bool separate = false;  // one after the other in any case, each in all of TileOptions::memoryBytes
    bool level = false;  // brings a full-resolution colour to the level of the other (levelledColour()), as it must be
  };

  struct Options {
    bool fp16 = false;                // storage of activations and weights; arithmetic is fp32
    std::optional<float> exposure{};  // factor on the colour, see isExposure(); empty: from the mean log luminance
    bool profile = false;
    /// Passes over the frame: 1, or the mean of 2 (also turned by half a turn), 4 (mirrored both ways) or 8 (also on
    /// the diagonal, not with TileOptions::wrap), for as many times the time. Normals are taken to be in the camera's
    /// axes. Not with SkipOptions::keepUnchanged.
    uint32_t ensemble = 1;
    TileOptions tiles{};  // of a frame that does not fit the device
    SkipOptions skip{};
    /// A run is cut into submissions of about that much work: others wait for the device no longer than one takes.
    uint64_t multiplyAddsPerSubmission = uint64_t{16} << 30;
    Tune tune = Tune::automatic;
    Denoisers denoisers{};
    /// The colour was denoised before: of what the model changes in it only the part is taken that its file states
    /// ("denoised_darker", "denoised_brighter"; of most models all). With `denoisers` it is true in any case.
    bool denoisedColour = false;
    /// Hears how far the tuning is, with the share done in [0, 1]; returning false ends it, and the making of the
    /// upscaler, with Cancelled. What is known by then is kept.
    std::function<bool(double)> onTuning{};
  };
  /// Whether Tune::automatic would tune for frames of width x height low-resolution pixels: no tuning is known, no
  /// kernel family was asked for, no other process tunes the device, and by the pace that was measured on it in earlier
  /// runs a frame takes at least kSecondsThatPay. Unknown paces say no. Throws Error if there is no frame of that size.
  static bool paysToTune(const Device& device, const Model& model, uint32_t width, uint32_t height, bool fp16);
  static constexpr double kSecondsThatPay = 60;
  /// Whether it may be given as an exposure.
  static constexpr bool isExposure(float value) { return value >= 1e-30F && value <= 1e30F; }
  static constexpr uint32_t kSmallFrame = 256;  // low-resolution pixels
  /// The kernels of a frame of width x height low-resolution pixels on a device that runs `family`, where no family was
  /// asked for: "plain" in place of "lane" for frames of at most kSmallFrame pixels.
  static std::string kernelFamily(const std::string& family, uint32_t width, uint32_t height);
  /// Called between submissions with the finished share in [0, 1]; returning false cancels the run.
  using Progress = std::function<bool(double)>;
  struct ProfileRow {
    std::string label, program;
    uint64_t multiplyAdds = 0, bytes = 0;
    double microseconds = 0;
  };
  /// How far the device is from the double-precision reference at one operator.
  struct CheckRow {
    std::string label;
    double relativeRms = 0;
    bool finite = true, withinBound = true;
  };

  /// width x height: of the low-resolution colour. Device and models must outlive the upscaler. Throws Error if an
  /// option is out of range; OutOfMemory if device or TileOptions::memoryBytes have no room for the smallest tiles of
  /// the frame; Cancelled if Device::Options::onPreparation says so. Small frames take the plain kernels on CPU devices
  /// unless a family was asked for (kernelFamily()): they start in a tenth of the time.
  Upscaler(Device& device, const Model& model, uint32_t width, uint32_t height, const Options& options);

  /// Upscales one frame. colour [height, width], auxiliary [scale height, scale width] each in the model's order;
  /// output: 3 floats a pixel, [scale height, scale width], apart from the inputs, finite whatever they are: see
  /// repairs(). Throws Error if
  /// a size does not fit or the device fails. Returns false if `progress` cancelled the run; of a frame in tiles, some
  /// are then written to the output.
  bool run(const PixelView& colour, std::span<const PixelView> auxiliary, std::span<float> output,
           const Progress& progress = {});

  /// The same with light layers, each set of which is upscaled so that it adds up to the output: see LayerSet. Throws
  /// Error also if a layer does not fit, or the upscaler skips windows. Another number of layers than in the run before
  /// plans and records anew.
  bool run(const PixelView& colour, std::span<const PixelView> auxiliary, std::span<float> output,
           std::span<const LayerSet> layers, const Progress& progress = {});
  const std::vector<LayerReport>& layerReports() const { return layerReports_; }  // of the last run, one a set

  /// Pixels of the last run that were not finite: of the inputs, filled from their finite neighbours, and of the
  /// network's output, which then was left out, so that the base image shows; of an ensemble, in any pass.
  struct Repairs {
    uint64_t colour = 0, auxiliary = 0, output = 0;
  };
  Repairs repairs() const;
  /// Of the last run, while one goes on that before it; of its last pass, as all that follow.
  float exposure() const { return xrdsGetExposure(handle()); }
  uint64_t deviceBytes() const { return xrdsGetDeviceBytes(handle()); }  // arena and weights
  const Tiling& tiling() const { return tiling_; }
  SkipMap skipMap() const;                  // of the last run
  std::vector<ProfileRow> profile() const;  // each dispatch of the last run, or pass; empty without Options::profile

  /// Replays one frame with every value kept and compares each operator with its double-precision reference on the
  /// host. Slow: seconds for 16 x 16 pixels.
  static std::vector<CheckRow> check(Device& device, const Model& model, const PixelView& colour,
                                     std::span<const PixelView> auxiliary, const Options& options);
  /// Tries hostile images and weights, as xrds/stress.h has it; minutes.
  static StressReport stress(Device& device, const StressOptions& options);

  /// For the functions of the C API; valid as long as the upscaler lives.
  XrdsUpscaler* handle() const { return handle_.get(); }

  /// As Device::finish(), of the upscaler's device.
  void finish(XrdsResult result) const { listener_ ? listener_->finish(result) : call::check(result); }

 private:
  std::shared_ptr<Device::Listener> listener_;
  call::Owned<XrdsUpscaler> handle_;
  std::vector<std::string> inputs_;  // of the model
  uint32_t width_ = 0, height_ = 0;  // of the output
  Tiling tiling_;
  std::vector<LayerReport> layerReports_;
};

}  // namespace xrds

#include "xrds/upscaler_inline.h"
