#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "xrds/error.h"
#include "xrds/pixel_view.h"
#include "xrds/skip.h"
#include "xrds/tiling.h"

/// xrds upscales Monte Carlo renders on any Vulkan device: open a Device, load a Model, make an Upscaler for a frame
/// size, run it for each frame. Every function may throw Error; an object is used by one thread at a time.
namespace xrds {

/// A Vulkan 1.2 device, opened for compute.
class Device {
 public:
  struct Description {
    std::string name;
    std::string kind;  // "discrete", "integrated", "virtual", "cpu" or "other"
    std::string uuid;  // 32 hexadecimal digits
    std::string driver, apiVersion;
    uint64_t memoryBytes = 0;
  };
  struct Options {
    /// Empty: the best device. Else its index in list(), a part of its name, or its UUID.
    std::string select{};
    /// Where compiled pipelines are kept; empty: the user's cache folder.
    std::filesystem::path cacheFolder{};
    /// Vulkan validation layers; their messages go to onMessage.
    bool validation = false;
    std::function<void(std::string_view)> onMessage{};
    /// Vulkan extensions to enable, for a program that draws on the same device (xrds/engine_access.h).
    std::vector<std::string> instanceExtensions{}, deviceExtensions{};
  };

  /// All devices; the index is what Options::select takes. Throws Error if there is no Vulkan loader.
  static std::vector<Description> list();

  /// Throws Error if no device fits, naming those there are.
  explicit Device(const Options& options);
  Device() : Device(Options{}) {}
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;
  Description description() const;

 private:
  friend class Upscaler;
  friend struct EngineAccess;
  friend struct Examination;
  struct State;
  std::unique_ptr<State> state_;
};

/// A trained network, checked to be complete. Immutable: may be shared between threads.
class Model {
 public:
  /// Reads a safetensors model file. Throws Error if it is no complete, finite model of a known architecture.
  explicit Model(const std::filesystem::path& file);
  /// A model without a network, the rivals to beat: base "bicubic" (no auxiliary image), "demodulated" (albedo, normal)
  /// or "guided" (albedo, normal); transfer "log1p" or "none". Throws Error for any other name.
  static Model untrained(uint32_t scale, const std::string& base, const std::string& transfer = "log1p");
  ~Model();
  Model(Model&&) noexcept;
  Model& operator=(Model&&) noexcept;

  uint32_t scale() const;
  /// The images that go with the colour, in the order in which Upscaler::run takes them: "albedo", "normal", ...
  const std::vector<std::string>& auxiliaryInputs() const;
  const std::map<std::string, std::string>& metadata() const;
  /// Of the file's bytes, as 16 hexadecimal digits.
  std::string hash() const;
  std::string whyNeverSkipped() const;  // as the end of a sentence; empty if SkipOptions::bound may be set

  /// What an output of width x height pixels costs in one piece; a pure question, no device needed. Device memory:
  /// `plannedBytes` is the arena, `lowerBoundBytes` the largest set of values alive at once, `unaliasedBytes` the sum
  /// of all. Multiply-adds of token pairs in attention stand beside those of linear maps and convolutions.
  struct Cost {
    uint64_t parameters = 0, multiplyAdds = 0, attentionMultiplyAdds = 0;
    uint64_t plannedBytes = 0, lowerBoundBytes = 0, unaliasedBytes = 0, weightBytes = 0;
  };
  Cost cost(uint32_t outputWidth, uint32_t outputHeight, bool fp16) const;
  /// The tiles of an output of that size; memoryBytes 0 sets no limit here. Throws Error if no tiles fit.
  Tiling tiling(uint32_t outputWidth, uint32_t outputHeight, bool fp16, const TileOptions& options) const;

 private:
  friend class Upscaler;
  struct State;
  explicit Model(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

struct StressOptions;
struct StressReport;

/// A model made ready for one frame size on one device: planned and recorded once, replayed for each frame. A frame
/// that does not fit the device's memory or limits is cut into tiles.
class Upscaler {
 public:
  struct Options {
    bool fp16 = false;                // storage of activations and weights; arithmetic is fp32
    std::optional<float> exposure{};  // factor on the colour, 1e-30 to 1e30; empty: from the mean log luminance
    bool profile = false;
    TileOptions tiles{};  // of a frame that does not fit the device
    SkipOptions skip{};
    /// A run is cut into submissions of about that much work: others wait for the device no longer than one takes.
    uint64_t multiplyAddsPerSubmission = uint64_t{16} << 30;
  };
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

  /// width x height: of the low-resolution colour. Device and model must outlive the upscaler. Throws Error if the
  /// device cannot hold even the smallest tiles of the frame, or if the exposure is out of range.
  Upscaler(Device& device, const Model& model, uint32_t width, uint32_t height, const Options& options);
  ~Upscaler();
  Upscaler(Upscaler&&) noexcept;
  Upscaler& operator=(Upscaler&&) noexcept;

  /// Upscales one frame. colour [height, width], auxiliary [scale height, scale width] each in the model's order;
  /// output: 3 floats a pixel, [scale height, scale width], finite whatever the inputs: see repairs(). Throws Error if
  /// a size does not fit or the device fails. Returns false if `progress` cancelled the run; of a frame in tiles, some
  /// are then written to the output.
  bool run(const PixelView& colour, std::span<const PixelView> auxiliary, std::span<float> output,
           const Progress& progress = {});

  /// Pixels of the last run that were not finite: of the inputs, filled from their finite neighbours, and of the
  /// network's output, which then was left out, so that the base image shows.
  struct Repairs {
    uint64_t colour = 0, auxiliary = 0, output = 0;
  };
  Repairs repairs() const;
  float exposure() const;        // of the last run
  uint64_t deviceBytes() const;  // arena and weights
  const Tiling& tiling() const;
  SkipMap skipMap() const;                  // of the last run
  std::vector<ProfileRow> profile() const;  // of each dispatch in the last run; empty without Options::profile

  /// Replays one frame with every value kept and compares each operator with its double-precision reference on the
  /// host. Slow: seconds for 16 x 16 pixels.
  static std::vector<CheckRow> check(Device& device, const Model& model, const PixelView& colour,
                                     std::span<const PixelView> auxiliary, const Options& options);
  /// Tries hostile images and weights, as xrds/stress.h has it; minutes.
  static StressReport stress(Device& device, const StressOptions& options);

 private:
  friend struct EngineAccess;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace xrds
