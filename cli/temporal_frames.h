#pragma once

#include "app/moving_frame.h"
#include "cli/sequence_plan.h"
#include "cli/upscale_input.h"
#include "sequence/shared_reads.h"

namespace xrds {

/// Reads the frames of a sequence, with --temporal each with those around it whose files are there, whether or not they
/// belong to the range: so a frame comes out the same however a sequence is cut. For several threads at once.
class TemporalFrames {
 public:
  /// Everything must outlive it. readers: threads that read at once.
  TemporalFrames(const UpscaleOptions& options, const OpenedModel& opened, const SequencePlan& plan, size_t readers);

  /// Without --temporal the frame alone. Throws Failure if it cannot be read.
  FrameGroup read(const SequenceFrame& frame);

 private:
  MovingFrame readOne(const SequenceFrame& frame) const;

  const UpscaleOptions& options_;
  const OpenedModel& opened_;
  const SequencePlan& plan_;
  size_t readers_;
  SharedReads<MovingFrame> shared_;
};

}  // namespace xrds
