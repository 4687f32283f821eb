#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "app/frame_motion.h"
#include "cli/sequence_plan.h"
#include "cli/upscale_input.h"
#include "sequence/shared_reads.h"

namespace xrds {

/// A frame of a sequence and how it moves, where --temporal asks for that.
struct MovingFrame {
  Frame frame;
  FrameMotion motion{};
};

/// A frame and those around it, the nearest first; none without --temporal.
struct FrameGroup {
  std::shared_ptr<const MovingFrame> present;
  std::vector<std::shared_ptr<const MovingFrame>> before, after;
};

/// Reads the frames of a sequence, with --temporal each with those around it whose files are there, whether or not they
/// belong to the range: so a frame comes out the same however a sequence is cut. For several threads at once.
class TemporalFrames {
 public:
  /// Everything must outlive it. readers: threads that read at once.
  TemporalFrames(const UpscaleOptions& options, const OpenedModel& opened, const SequencePlan& plan, size_t readers);

  /// Throws Failure if the frame itself cannot be read; of those around it such a one ends the row.
  FrameGroup read(const SequenceFrame& frame);

 private:
  MovingFrame readOne(const SequenceFrame& frame) const;
  std::vector<std::shared_ptr<const MovingFrame>> row(const SequenceFrame& frame, const MovingFrame& present, int step);

  const UpscaleOptions& options_;
  const OpenedModel& opened_;
  const SequencePlan& plan_;
  SharedReads<MovingFrame> shared_;
};

/// The frame of a group, merged with the others (TemporalFilter) and then, with --denoise-first, denoised; alone as it
/// is. `filter` is made anew where it does not fit the frame. Throws Error.
class GroupMerger {
 public:
  GroupMerger(const UpscaleOptions& options, uint32_t scale) : options_(options), scale_(scale) {}
  std::shared_ptr<const Frame> merged(Device& device, const FrameGroup& group);
  /// What it holds of a device that goes.
  void release() { filter_.reset(); }

 private:
  const UpscaleOptions& options_;
  uint32_t scale_;
  std::optional<TemporalFilter> filter_;
  uint32_t width_ = 0, height_ = 0;
};

}  // namespace xrds
