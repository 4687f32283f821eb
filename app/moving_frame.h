#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "app/frame_motion.h"

namespace xrds {

/// A frame of a sequence and how it moves.
struct MovingFrame {
  Frame frame;
  FrameMotion motion{};
};
using SharedFrame = std::shared_ptr<const MovingFrame>;

/// A frame and those around it, the nearest first.
struct FrameGroup {
  SharedFrame present;
  std::vector<SharedFrame> before, after;
  uint32_t radius = 0;            // how many each side were asked for
  std::vector<int> unreadable{};  // frames that are there and cannot be read, which ended a row
};

/// The frame `number` and up to `radius` frames before and after it, by default more where most of it stands
/// still, as far as there is motion to follow and frames have its size. `read`: a frame by its number; null where there
/// is none. Throws Failure if `number` itself cannot be read; another such frame ends its row.
FrameGroup groupAround(int number, std::optional<uint32_t> radius, const std::function<SharedFrame(int)>& read);

/// Merges groups, of frames of any size, on a device (TemporalFilter).
class GroupMerger {
 public:
  explicit GroupMerger(uint32_t scale) : scale_(scale) {}

  /// The frame of the group, merged with the others. The filter is made anew where it does not fit the frame. Throws
  /// Error.
  Frame merged(Device& device, const FrameGroup& group);

  /// Lets go of what it holds of the device.
  void release() { filter_.reset(); }

 private:
  uint32_t scale_;
  std::optional<TemporalFilter> filter_;
  uint32_t width_ = 0, height_ = 0;
};

}  // namespace xrds
