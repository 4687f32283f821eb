#include "cli/temporal_frames.h"

#include <system_error>

#include "app/failing_with.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

bool isThere(const fs::path& path) {
  std::error_code ignored;
  return path.empty() || fs::exists(path, ignored);
}

// Merging comes before the denoiser, which has no need of it.
UpscaleOptions asRead(UpscaleOptions options) {
  if (options.temporal) options.denoiseFirst = options.cleanGuides = false;
  return options;
}

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

}  // namespace

TemporalFrames::TemporalFrames(const UpscaleOptions& options, const OpenedModel& opened, const SequencePlan& plan,
                               size_t readers)
    : options_(options),
      opened_(opened),
      plan_(plan),
      shared_(2 * size_t{options.temporalRadius} + 1 + readers,
              [this](int number) { return readOne(plan_.frame(number)); }) {}

MovingFrame TemporalFrames::readOne(const SequenceFrame& frame) const {
  MovingFrame read{readFrame(asRead(frame.alone(options_)), opened_)};
  if (options_.temporal)
    read.motion = failingWith(ExitCode::input, [&] {
      return readMotion(read.frame, options_.motion, options_.layers.nameOf(AovRole::kDepth));
    });
  return read;
}

std::vector<std::shared_ptr<const MovingFrame>> TemporalFrames::row(const SequenceFrame& frame,
                                                                    const MovingFrame& present, int step) {
  std::vector<std::shared_ptr<const MovingFrame>> found;
  for (int away = 1; away <= static_cast<int>(options_.temporalRadius); ++away) {
    const MovingFrame& last = found.empty() ? present : *found.back();
    if ((step < 0 ? last.motion.toPrevious : last.motion.toNext).empty()) break;
    const SequenceFrame next = plan_.frame(frame.number + step * away);
    if (!isThere(next.colour) || !isThere(next.auxiliary)) break;
    try {
      auto read = shared_.get(next.number);
      if (read->frame.width() != present.frame.width() || read->frame.height() != present.frame.height()) break;
      found.push_back(std::move(read));
    } catch (const Failure&) {  // told when its turn comes
      break;
    }
  }
  return found;
}

FrameGroup TemporalFrames::read(const SequenceFrame& frame) {
  if (!options_.temporal) return {std::make_shared<const MovingFrame>(readOne(frame)), {}, {}};
  FrameGroup group{shared_.get(frame.number), {}, {}};
  group.before = row(frame, *group.present, -1);
  group.after = row(frame, *group.present, 1);
  return group;
}

std::shared_ptr<const Frame> GroupMerger::merged(Device& device, const FrameGroup& group) {
  const Frame& present = group.present->frame;
  if (!options_.temporal) return {group.present, &present};
  if (!filter_ || width_ != present.width() || height_ != present.height()) {
    filter_.reset();  // its memory may be needed
    width_ = present.width();
    height_ = present.height();
    filter_.emplace(device, width_, height_, scale_);
  }
  const auto framesOf = [](const auto& row) {
    std::vector<TemporalFilter::Frame> frames;
    for (const auto& moving : row) frames.push_back(filterFrame(*moving));
    return frames;
  };
  auto frame = std::make_shared<Frame>(present);
  frame->replace(filter_->run(filterFrame(*group.present), framesOf(group.before), framesOf(group.after)));
  if (options_.denoiseFirst) frame->denoise(Denoiser(), options_.cleanGuides, options_.ensemble);
  return frame;
}

}  // namespace xrds
