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

// Merging comes before the denoiser, which has no need of it. Lights are read of the present frame alone.
UpscaleOptions asRead(UpscaleOptions options) {
  if (!options.temporal) return options;
  options.denoiseFirst = options.cleanGuides = false;
  options.lights.clear();
  return options;
}

}  // namespace

TemporalFrames::TemporalFrames(const UpscaleOptions& options, const OpenedModel& opened, const SequencePlan& plan,
                               size_t readers)
    : options_(options),
      opened_(opened),
      plan_(plan),
      readers_(readers),
      shared_(2 * size_t{options.temporalRadius.value_or(TemporalFilter::kRadius)} + 1 + readers,
              [this](int number) { return readOne(plan_.frame(number)); }) {}

MovingFrame TemporalFrames::readOne(const SequenceFrame& frame) const {
  MovingFrame read{readFrame(asRead(frame.alone(options_)), opened_)};
  if (options_.temporal && opened_.model.scale() > 1 && read.frame.scale() == 0)
    throw Failure{ExitCode::usage,
                  "--temporal merges frames along the motion of a full-resolution render, and the model '" +
                      opened_.name() + "' takes none: choose one that takes albedo or normal."};
  if (options_.temporal)
    read.motion = failingWith(ExitCode::input, [&] {
      const auto beside = [&](int step) {
        const SequenceFrame other = plan_.frame(frame.number + step);
        return other.auxiliary.empty() ? other.colour : other.auxiliary;
      };
      return readMotion(read.frame, {options_.motion, options_.layers.nameOf(AovRole::kDepth), beside(-1), beside(1)});
    });
  return read;
}

FrameGroup TemporalFrames::read(const SequenceFrame& frame) {
  if (!options_.temporal) return {std::make_shared<const MovingFrame>(readOne(frame)), {}, {}};
  FrameGroup group = groupAround(frame.number, options_.temporalRadius, [&](int number) -> SharedFrame {
    const SequenceFrame files = plan_.frame(number);
    if (number != frame.number && (!isThere(files.colour) || !isThere(files.auxiliary))) return nullptr;
    return shared_.get(number);
  });
  shared_.keep(2 * size_t{group.radius} + 1 + readers_);
  if (const LayerRequest lights = layerRequest(options_.lights); lights.any()) {
    auto present = std::make_shared<MovingFrame>(*group.present);
    failingWith(ExitCode::input, [&] { present->frame.loadLayers(lights, opened_.model.scale()); });
    group.present = std::move(present);
  }
  return group;
}

}  // namespace xrds
