#include "cli/upscale_sequence.h"

#include <memory>

#include "app/failing_with.h"
#include "cli/alpha.h"
#include "cli/first_denoiser.h"
#include "cli/progress.h"
#include "cli/sequence_run.h"
#include "cli/upscale_frame.h"
#include "cli/upscale_report.h"

namespace xrds {
namespace {

/// Upscales frames, by what is recorded on the device for their size.
class UpscaledFrames : public FrameMaker {
 public:
  /// The references must outlive it.
  UpscaledFrames(const UpscaleOptions& options, const UpscaleInput& first)
      : options_(options),
        first_(first),
        denoiser_(options, FirstDenoiser::Frames::many, [](double) { return !interrupted(); }),
        merger_(model().scale()) {}

  void begin(Device& device) override { tuneFirst(device, first_, options_); }

  MadeFrame make(Device& device, const FrameGroup& group) override {
    if (denoiser_.goesAlong(group.present->frame)) prepareFor(device, group.present->frame);
    const std::shared_ptr<const Frame> read = frameOf(device, group);
    const Frame& frame = *read;
    prepareFor(device, frame);
    Upscaled result = upscaledBy(*upscaler_, model(), frame, [](double) { return !interrupted(); });
    MadeFrame made{.output = outputOf(options_, first_.opened, frame, result.exposure),
                   .warnings = warningsOf(result, frame, options_)};
    made.image = frame.alpha() ? withAlpha(result.colour, upscaleAlpha(*alpha_, *frame.alpha(), scale()))
                               : std::move(result.colour);
    if (frame.layers()) made.planes = frame.layers()->planes(made.image, result.layers, made.output.pixelType);
    return made;
  }

  void release() override {
    alpha_.reset();
    upscaler_.reset();
    merger_.release();
    denoiser_.release();
  }

 private:
  const Model& model() const { return first_.opened.model; }
  int scale() const { return static_cast<int>(model().scale()); }

  // With --temporal the merged one, denoised after that.
  std::shared_ptr<const Frame> frameOf(Device& device, const FrameGroup& group) {
    const Frame& present = group.present->frame;
    const bool onDevice = denoiser_.takes(present);
    if (!options_.temporal && !onDevice) return {group.present, &present};
    auto frame = std::make_shared<Frame>(options_.temporal ? merger_.merged(device, group) : present);
    if (onDevice) {
      if (!options_.memory.empty()) release();  // it is for the networks alone
      denoiser_.denoise(device, *frame);
    } else if (options_.denoiseFirst) {
      denoiseByLibrary(options_, *frame);
    }
    return frame;
  }

  void prepareFor(Device& device, const Frame& frame) {
    if (!upscaler_ || width_ != frame.width() || height_ != frame.height()) {
      alpha_.reset();
      upscaler_.reset();  // its memory may be needed
      width_ = frame.width();
      height_ = frame.height();
      if (denoiser_.goesAlong(frame))
        denoiser_.prepare(upscaler_, device, model(), frame);
      else
        upscaler_.emplace(device, model(), width_, height_, options_.upscaler());
    }
    if (frame.alpha() && !alpha_) alpha_.emplace(device, width_, height_, model().scale(), options_.upscaler().tiles);
  }

  const UpscaleOptions& options_;
  const UpscaleInput& first_;
  FirstDenoiser denoiser_;
  std::optional<Upscaler> upscaler_;
  std::optional<AlphaUpscaler> alpha_;
  GroupMerger merger_;
  uint32_t width_ = 0, height_ = 0;
};

}  // namespace

void upscaleSequence(const UpscaleOptions& options) {
  refuse(!options.reference.empty(), "--reference", kForOneFrame);
  refuse(!options.preview.empty(), "--preview", kForOneFrame);
  refuse(!options.sideBySide.empty(), "--side-by-side", kForOneFrame);
  refuse(!options.skipMap.empty(), "--skip-map", kForOneFrame);
  refuse(!options.json.empty(), "--json", "is for one frame; --log is for sequences.");
  refuse(options.profile, "--profile", kForOneFrame);
  refuse(options.check, "--check", kForOneFrame);
  refuse(options.keepUnchanged && options.exposure == "auto", "--keep-unchanged",
         "needs --exposure E: an automatic one would make results depend on the frames before.");
  refuse(options.keepUnchanged && options.ensemble > 1, "--keep-unchanged", "and --ensemble exclude each other.");
  const std::optional<SequencePlan> plan = planMissing(options);
  if (!plan) return;
  const UpscaleInput first = openFirst(options, *plan);
  runSequence(options, *plan, first, [&] { return std::make_unique<UpscaledFrames>(options, first); });
}

}  // namespace xrds
