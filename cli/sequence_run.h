#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/moving_frame.h"
#include "cli/sequence_plan.h"
#include "cli/upscale_input.h"
#include "image/exr/write.h"

namespace xrds {

/// A result on its way to its file.
struct MadeFrame {
  Image image;
  std::vector<ExrPlane> planes{};  // all channels of the file, where it has layers
  ExrOutput output;
  std::vector<std::string> warnings{};
};

/// What a command makes of frames, one after the other, on a device that stays the same until release().
class FrameMaker {
 public:
  FrameMaker() = default;
  virtual ~FrameMaker() = default;
  FrameMaker(const FrameMaker&) = delete;
  FrameMaker& operator=(const FrameMaker&) = delete;

  /// Before the first frame: says and does what is to be said and done once. Throws Error, and Failure.
  virtual void begin(Device&) {}

  /// The result of the group's frame, with --temporal merged with the others. Throws Error, and Failure when
  /// interrupted.
  virtual MadeFrame make(Device& device, const FrameGroup& group) = 0;

  /// Lets go of what it holds of the device, which is lost.
  virtual void release() = 0;
};

/// Throws Failure with `why` if the option is given.
void refuse(bool given, const char* option, const char* why);
inline constexpr const char* kForOneFrame = "is for one frame, not for sequences.";

/// Whether the names are of many frames; of one, no options of sequences may be given. Throws Failure.
bool isSequence(const UpscaleOptions& options);

/// What there is to make, after everything about the log that can be known to fail; nothing, which is said, if all
/// frames are there. Throws Failure.
std::optional<SequencePlan> planMissing(const UpscaleOptions& options);

/// Opens the first frame that can be read, whose model the others have to fit. Throws Failure.
UpscaleInput openFirst(const UpscaleOptions& options, const SequencePlan& plan);

/// Reads, makes and writes different frames at once, each output whole or not at all, by one maker for each device and
/// each of its jobs. Throws Failure: with ExitCode::frames if some could not be made and all others were.
void runSequence(const UpscaleOptions& options, const SequencePlan& plan, const UpscaleInput& first,
                 const std::function<std::unique_ptr<FrameMaker>()>& newMaker);

}  // namespace xrds
