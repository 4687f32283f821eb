#include "viewer/moving_sequence.h"

#include "app/failing_with.h"

namespace xrds {

MovingSequence::MovingSequence(const Wanted& wanted)
    : sequence_(wanted.sequence),
      layers_(wanted.layers),
      merge_(wanted.merge),
      radius_(wanted.temporalRadius),
      motion_(wanted.motion),
      shared_(2 * size_t{radius_.value_or(TemporalFilter::kRadius)} + 1, [this](int number) { return read(number); }) {}

bool MovingSequence::isOf(const Wanted& wanted) const {
  return wanted.sequence == sequence_ && samePixels(wanted.layers, layers_) && wanted.merge.never == merge_.never;
}

MovingFrame MovingSequence::read(int number) const {
  return failingWith(ExitCode::input, [&] {
    const auto beside = [&](int step) {
      const FrameFiles* files = filesOf(*sequence_, number + step);
      return !files ? std::filesystem::path{} : files->auxiliary.empty() ? files->colour : files->auxiliary;
    };
    MovingFrame moving{readFrame(*filesOf(*sequence_, number), layers_, merge_)};
    moving.motion = readMotion(moving.frame, {motion_, layers_.nameOf(AovRole::kDepth), beside(-1), beside(1)});
    return moving;
  });
}

LoadedFrame MovingSequence::merged(Device& device, int number) {
  const FrameGroup group = groupAround(
      number, radius_, [this](int frame) { return filesOf(*sequence_, frame) ? shared_.get(frame) : nullptr; });
  shared_.keep(2 * size_t{group.radius} + 1);
  if (!merger_) merger_.emplace(static_cast<uint32_t>(group.present->frame.scale()));
  LoadedFrame loaded = loadedFrame(*filesOf(*sequence_, number), merger_->merged(device, group));
  loaded.merged = 1 + group.before.size() + group.after.size();
  return loaded;
}

}  // namespace xrds
