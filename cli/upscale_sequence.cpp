#include "cli/upscale_sequence.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <mutex>
#include <sstream>
#include <thread>

#include "app/failing_with.h"
#include "cli/alpha.h"
#include "cli/device_choice.h"
#include "cli/first_denoiser.h"
#include "cli/output_file.h"
#include "cli/sequence_plan.h"
#include "cli/sequence_report.h"
#include "cli/temporal_frames.h"
#include "cli/upscale_frame.h"
#include "cli/upscale_report.h"
#include "cli/warnings.h"
#include "sequence/file_pattern.h"
#include "sequence/frame_range.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

/// A result on its way to its file.
struct MadeFrame {
  Image image;
  std::vector<ExrPlane> planes;  // all channels of the file, where it has layers
  ExrOutput output;
  std::vector<std::string> warnings;
};

/// A device, opened anew after a failure, and what is recorded on it for the size of the frames.
class Worker {
 public:
  Worker(std::string select, const UpscaleOptions& options, const OpenedModel& opened)
      : select_(std::move(select)),
        options_(options),
        opened_(opened),
        denoiser_(options, FirstDenoiser::Frames::many, [](double) { return !interrupted(); }),
        merger_(opened.model.scale()) {}

  /// Opens the device, tunes it where that is asked for, and says what there is to say. Throws Failure.
  void open(const UpscaleInput& first) {
    withDevice([&] {
      printNotes(*device_);
      tuneFirst(*device_, first, options_);
    });
  }

  MadeFrame compute(const FrameGroup& group) {
    MadeFrame made;
    withDevice([&] {
      if (denoiser_.goesAlong(group.present->frame)) prepareFor(group.present->frame);
      const std::shared_ptr<const Frame> read = frameOf(group);
      const Frame& frame = *read;
      prepareFor(frame);
      Upscaled result = upscaledBy(*upscaler_, opened_.model, frame, [](double) { return !interrupted(); });
      made.warnings = warningsOf(result, frame, options_);
      made.output = outputOf(options_, opened_, frame, result.exposure);
      if (!group.unreadable.empty()) {
        const std::string frames = describeFrames(group.unreadable);
        made.output.texts[kMergedWithout] = frames;
        made.warnings.push_back("merged without frames that cannot be read: " + frames + "; when they can be, " +
                                "--skip-existing makes it again.");
      }
      made.image = frame.alpha() ? withAlpha(result.colour, upscaleAlpha(*alpha_, *frame.alpha(), scale()))
                                 : std::move(result.colour);
      if (frame.layers()) made.planes = frame.layers()->planes(made.image, result.layers, made.output.pixelType);
    });
    return made;
  }

 private:
  int scale() const { return static_cast<int>(opened_.model.scale()); }

  // With --temporal the merged one, denoised after that.
  std::shared_ptr<const Frame> frameOf(const FrameGroup& group) {
    const Frame& present = group.present->frame;
    const bool onDevice = denoiser_.takes(present);
    if (!options_.temporal && !onDevice) return {group.present, &present};
    auto frame = std::make_shared<Frame>(options_.temporal ? merger_.merged(*device_, group) : present);
    if (onDevice) {
      if (!options_.memory.empty()) release();  // it is for the networks alone
      denoiser_.denoise(*device_, *frame);
    } else if (options_.denoiseFirst) {
      denoiseByLibrary(options_, *frame);
    }
    return frame;
  }

  void release() {
    alpha_.reset();
    upscaler_.reset();
    merger_.release();
    denoiser_.release();
  }

  template <class Action>
  void withDevice(Action&& action) {
    try {
      failingWith(ExitCode::device, [&] {
        if (!device_) device_ = openDevice(select_, options_.quiet);
        action();
      });
    } catch (const Failure& failure) {
      if (failure.code == ExitCode::device) {
        release();
        device_.reset();
      }
      throw;
    }
  }

  void prepareFor(const Frame& frame) {
    if (!upscaler_ || width_ != frame.width() || height_ != frame.height()) {
      alpha_.reset();
      upscaler_.reset();  // its memory may be needed
      width_ = frame.width();
      height_ = frame.height();
      if (denoiser_.goesAlong(frame)) denoiser_.prepare(upscaler_, *device_, opened_.model, frame);
      if (!upscaler_) upscaler_.emplace(*device_, opened_.model, width_, height_, options_.upscaler());
    }
    if (frame.alpha() && !alpha_)
      alpha_.emplace(*device_, width_, height_, opened_.model.scale(), options_.upscaler().tiles);
  }

  const std::string select_;
  const UpscaleOptions& options_;
  const OpenedModel& opened_;
  std::unique_ptr<Device> device_;
  FirstDenoiser denoiser_;
  std::optional<Upscaler> upscaler_;
  std::optional<AlphaUpscaler> alpha_;
  GroupMerger merger_;
  uint32_t width_ = 0, height_ = 0;
};

// Names of the devices, as Device::Options::select takes them: one a worker.
std::vector<std::string> workersOf(const UpscaleOptions& options) {
  std::vector<std::string> devices;
  if (options.devices == "all") {
    const size_t count = failingWith(ExitCode::device, [] { return Device::list().size(); });
    for (size_t i = 0; i < count; ++i) devices.push_back(std::to_string(i));
  } else if (!options.devices.empty()) {
    std::istringstream list(options.devices);
    for (std::string device; std::getline(list, device, ',');) devices.push_back(device);
  } else {
    devices.push_back(options.device);
  }
  std::vector<std::string> workers;
  for (uint32_t job = 0; job < options.jobsPerDevice; ++job)
    workers.insert(workers.end(), devices.begin(), devices.end());
  return workers;
}

// The first frame that can be opened chooses the model; the others have to fit it.
UpscaleInput openFirst(const UpscaleOptions& options, const SequencePlan& plan) {
  std::optional<Failure> first;
  for (const SequenceFrame& frame : plan.frames) try {
      stopIfInterrupted();
      return openInput(frame.alone(options));
    } catch (const Failure& failure) {
      if (failure.code != ExitCode::input) throw;
      if (!first) first = failure;
    }
  throw Failure{ExitCode::input, "No frame can be read, the first: " + first->message};
}

void runSequence(const UpscaleOptions& options, const SequencePlan& plan) {
  const UpscaleInput first = openFirst(options, plan);
  const OpenedModel& opened = first.opened;
  std::vector<Worker> workers;
  for (const std::string& device : workersOf(options)) workers.emplace_back(device, options, opened);
  for (Worker& worker : workers) worker.open(first);

  const LineThreads threads = threadsFor(workers.size(), std::thread::hardware_concurrency());
  if (first.frame.layers() && !options.quiet) std::fputs(layersText(first.frame.layers()->list()).c_str(), stdout);
  SequenceReport report(options, plan, threads);
  std::mutex warning;
  const auto warn = [&](size_t index, const std::vector<std::string>& warnings) {
    const std::lock_guard lock(warning);
    report.warn(plan.frames[index].number, warnings);
  };
  TemporalFrames frames(options, opened, plan, threads.readers);
  const LineStages<FrameGroup, MadeFrame> stages{
      .read = [&](size_t index) -> std::optional<FrameGroup> {
        const SequenceFrame& frame = plan.frames[index];
        if (options.skipExisting && isMade(frame)) return {};
        FrameGroup read = frames.read(frame);
        warn(index, read.present->frame.warnings());
        return read;
      },
      .compute = [&](const FrameGroup& group, size_t worker) { return workers[worker].compute(group); },
      .write =
          [&](MadeFrame made, size_t index) {
            failingWith(ExitCode::output, [&] {
              const fs::path& file = plan.frames[index].output;
              if (made.planes.empty())
                writeExr(file, made.image, made.output);
              else
                writeExr(file, made.planes, made.output);
            });
            warn(index, made.warnings);
          }};
  runLine<FrameGroup, MadeFrame>(plan.frames.size(), threads, stages,
                                 [&](const Outcome& outcome) { return report.add(outcome); });
  report.finish();
}

void refuse(bool given, const char* option, const char* why) {
  if (given) throw Failure{ExitCode::usage, std::string(option) + " " + why};
}

}  // namespace

bool isSequence(const UpscaleOptions& options) {
  if (FilePattern::mayBeMany(options.color) || (!options.aux.empty() && FilePattern::mayBeMany(options.aux)))
    return true;
  constexpr const char* kWhy = "is for sequences: put #### in the names of the files.";
  refuse(!options.frames.empty(), "--frames", kWhy);
  refuse(options.skipExisting, "--skip-existing", kWhy);
  refuse(options.keepUnchanged, "--keep-unchanged", kWhy);
  refuse(options.temporal, "--temporal", kWhy);
  refuse(!options.devices.empty(), "--devices", kWhy);
  refuse(options.jobsPerDevice > 1, "--jobs-per-device", kWhy);
  refuse(!options.log.empty(), "--log", kWhy);
  return false;
}

void upscaleSequence(const UpscaleOptions& options) {
  constexpr const char* kWhy = "is for one frame, not for sequences.";
  refuse(!options.reference.empty(), "--reference", kWhy);
  refuse(!options.preview.empty(), "--preview", kWhy);
  refuse(!options.sideBySide.empty(), "--side-by-side", kWhy);
  refuse(!options.skipMap.empty(), "--skip-map", kWhy);
  refuse(!options.json.empty(), "--json", "is for one frame; --log is for sequences.");
  refuse(options.profile, "--profile", kWhy);
  refuse(options.check, "--check", kWhy);
  refuse(options.keepUnchanged && options.exposure == "auto", "--keep-unchanged",
         "needs --exposure E: an automatic one would make results depend on the frames before.");
  refuse(options.keepUnchanged && options.ensemble > 1, "--keep-unchanged", "and --ensemble exclude each other.");
  if (!options.log.empty()) {
    requireExtension(options.log, ".json", "--log");
    requireWritable(options.log);
  }
  const SequencePlan plan = planSequence(options);
  if (plan.frames.empty()) {
    if (!options.quiet) std::printf("%s: all %zu frames are there\n", plan.output.c_str(), plan.there.size());
    return;
  }
  runSequence(options, plan);
}

}  // namespace xrds
