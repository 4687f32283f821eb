#pragma once

#include <memory>

#include "app/moving_frame.h"
#include "sequence/shared_reads.h"
#include "viewer/upscaling/wanted.h"

namespace xrds {

/// The frames of a sequence, each merged with those around it, as `xrds upscale --temporal` does. Used by one thread.
class MovingSequence {
 public:
  /// Reads nothing yet.
  explicit MovingSequence(const Wanted& wanted);

  /// Whether it is that of another wish, too.
  bool isOf(const Wanted& wanted) const;

  /// The frame merged on the device. Throws Failure if it cannot be read or has no motion, Error if the device fails.
  LoadedFrame merged(Device& device, int number);

 private:
  MovingFrame read(int number) const;

  std::shared_ptr<const Sequence> sequence_;
  AovRequest layers_;
  MergeRequest merge_;
  std::optional<uint32_t> radius_;
  std::string motion_;
  SharedReads<MovingFrame> shared_;
  std::optional<GroupMerger> merger_;  // of the frames' scale
};

}  // namespace xrds
