#include "cli/denoise_sequence.h"

#include <memory>

#include "app/failing_with.h"
#include "cli/alpha.h"
#include "cli/progress.h"
#include "cli/sequence_run.h"

namespace xrds {
namespace {

/// Denoises frames, with --temporal those that are merged with others. Networks stay prepared from one to the next,
/// unless --memory is given.
class DenoisedFrames : public FrameMaker {
 public:
  /// The options must outlive it.
  explicit DenoisedFrames(const DenoiseOptions& options) : options_(options), networks_(networks(options)) {}

  MadeFrame make(Device& device, const FrameGroup& group) override {
    std::optional<Frame> merged;
    if (options_.common.temporal) merged = merger_.merged(device, group);
    const Frame& frame = merged ? *merged : group.present->frame;
    const Denoised found = denoised(networks_, device, frame, options_);
    MadeFrame made{.image = frame.alpha() ? withAlpha(found.picture, *frame.alpha()) : found.picture,
                   .output = outputOf(options_, frame, networks_.name())};
    if (!frame.layers()) return made;
    made.planes = frame.layers()->planes(made.image, found.layers, made.output.pixelType);
    made.warnings = frame.layers()->warnings(found.layers);
    return made;
  }

  void release() override {
    merger_.release();
    networks_.release();
  }

 private:
  static NetworkDenoiser::Options networks(const DenoiseOptions& options) {
    NetworkDenoiser::Options found = networksOf(options, [](double) { return !interrupted(); });
    found.staysPrepared = options.common.memory.empty();
    return found;
  }

  const DenoiseOptions& options_;
  NetworkDenoiser networks_;
  GroupMerger merger_{1};
};

// The network of the colour, of the images that the first frame has whose files are there: it reads the frames as
// their model. Throws Failure.
std::string networkOf(const DenoiseOptions& options, const SequencePlan& plan) {
  std::optional<Failure> first;
  for (const SequenceFrame& frame : plan.frames) try {
      const size_t guides = failingWith(ExitCode::input, [&] {
        return openFrame(options, frame.colour.string(), frame.auxiliary.string()).inputs().size();
      });
      NetworkDenoiser networks(networksOf(options, {}));
      return failingWith(ExitCode::model, [&] {
        const bool isPrefiltered = arePrefiltered(options, guides);
        networks.load(guides, areClean(options), isPrefiltered);
        return networks.colourFile(guides, areClean(options) || isPrefiltered).string();
      });
    } catch (const Failure& failure) {
      if (failure.code != ExitCode::input) throw;
      if (!first) first = failure;
    }
  throw Failure{ExitCode::input, "No frame can be read, the first: " + first->message};
}

}  // namespace

void denoiseSequence(const DenoiseOptions& asked) {
  refuse(!asked.common.preview.empty(), "--preview", kForOneFrame);
  const std::optional<SequencePlan> plan = planMissing(asked.common);
  if (!plan) return;
  DenoiseOptions options = asked;
  options.common.model = networkOf(options, *plan);
  const UpscaleInput first = openFirst(options.common, *plan);
  runSequence(options.common, *plan, first, [&] { return std::make_unique<DenoisedFrames>(options); });
}

}  // namespace xrds
