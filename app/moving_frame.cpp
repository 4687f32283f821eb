#include "app/moving_frame.h"

#include <cmath>

#include "app/exit_code.h"

namespace xrds {
namespace {

PixelView viewOrNone(const Image* image) { return image ? viewOf(*image) : PixelView{}; }

TemporalFilter::Frame filterFrame(const MovingFrame& moving) {
  const auto& [frame, motion] = moving;
  return {.colour = viewOf(frame.colour()),
          .fullColour = viewOrNone(frame.imageOf(kFullColour.name)),
          .albedo = viewOrNone(frame.imageOf(kAlbedo.name)),
          .normal = viewOrNone(frame.imageOf(kNormal.name)),
          .depth = motion.depth,
          .toPrevious = motion.toPrevious,
          .toNext = motion.toNext};
}

std::vector<TemporalFilter::Frame> filterFrames(const std::vector<SharedFrame>& row) {
  std::vector<TemporalFilter::Frame> frames;
  for (const SharedFrame& moving : row) frames.push_back(filterFrame(*moving));
  return frames;
}

// More where most of the picture stands still.
uint32_t suitableRadius(const FrameMotion& motion) {
  constexpr float kStill = 0.01F;  // pixels
  const std::vector<float>& along = motion.toPrevious.empty() ? motion.toNext : motion.toPrevious;
  size_t still = 0;
  for (size_t i = 0; i + 1 < along.size(); i += 2)
    still += std::abs(along[i]) < kStill && std::abs(along[i + 1]) < kStill;
  return !along.empty() && 4 * still >= along.size() ? TemporalFilter::kRadiusOfStill : TemporalFilter::kRadius;
}

}  // namespace

FrameGroup groupAround(int number, std::optional<uint32_t> radius, const std::function<SharedFrame(int)>& read) {
  FrameGroup group{read(number), {}, {}};
  group.radius = radius ? *radius : suitableRadius(group.present->motion);
  const Frame& present = group.present->frame;
  const auto addRow = [&](int step, std::vector<float> FrameMotion::*motion, std::vector<SharedFrame>& row) {
    SharedFrame last = group.present;
    for (int away = 1; away <= static_cast<int>(group.radius); ++away) try {
        if ((last->motion.*motion).empty() && !last->motion.byCameras) return;
        SharedFrame next = read(number + step * away);
        if (!next || (last->motion.*motion).empty()) return;
        if (next->frame.width() != present.width() || next->frame.height() != present.height()) return;
        row.push_back(last = std::move(next));
      } catch (const Failure&) {  // told when its turn comes
        return group.unreadable.push_back(number + step * away);
      }
  };
  addRow(-1, &FrameMotion::toPrevious, group.before);
  addRow(1, &FrameMotion::toNext, group.after);
  return group;
}

Frame GroupMerger::merged(Device& device, const FrameGroup& group) {
  Frame frame = group.present->frame;
  if (!filter_ || width_ != frame.width() || height_ != frame.height()) {
    filter_.reset();  // its memory may be needed
    width_ = frame.width();
    height_ = frame.height();
    filter_.emplace(device, width_, height_, scale_);
  }
  frame.replace(filter_->run(filterFrame(*group.present), filterFrames(group.before), filterFrames(group.after)));
  return frame;
}

}  // namespace xrds
