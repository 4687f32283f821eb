#include "cli/sequence_run.h"

#include <cstdio>
#include <mutex>
#include <sstream>
#include <thread>

#include "app/constant_input.h"
#include "app/failing_with.h"
#include "cli/device_choice.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/sequence_report.h"
#include "cli/temporal_frames.h"
#include "cli/upscale_report.h"
#include "cli/warnings.h"
#include "sequence/file_pattern.h"
#include "sequence/frame_range.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

/// A device, opened anew after a failure, and the maker that works on it.
class Worker {
 public:
  Worker(std::string select, bool quiet, std::unique_ptr<FrameMaker> maker)
      : select_(std::move(select)), quiet_(quiet), maker_(std::move(maker)) {}

  /// Opens the device, and says what there is to say. Throws Failure.
  void open() {
    withDevice([&] {
      printNotes(*device_);
      maker_->begin(*device_);
    });
  }

  MadeFrame compute(const FrameGroup& group) {
    MadeFrame made;
    withDevice([&] { made = maker_->make(*device_, group); });
    const size_t frames = 1 + group.before.size() + group.after.size();
    if (frames > 1) made.output.texts["xrds:options"] += " temporal=" + std::to_string(frames);
    if (!group.unreadable.empty()) {
      const std::string missing = describeFrames(group.unreadable);
      made.output.texts[kMergedWithout] = missing;
      made.warnings.push_back("merged without frames that cannot be read or merged: " + missing +
                              "; --skip-existing makes it again once they can be.");
    }
    return made;
  }

 private:
  template <class Action>
  void withDevice(Action&& action) {
    try {
      failingWith(ExitCode::device, [&] {
        if (!device_) device_ = openDevice(select_, quiet_);
        untilInterrupted(action);
      });
    } catch (const Failure& failure) {
      if (failure.code == ExitCode::device) {
        maker_->release();
        device_.reset();
      }
      throw;
    }
  }

  const std::string select_;
  const bool quiet_;
  std::unique_ptr<Device> device_;  // what the maker holds of it goes before
  std::unique_ptr<FrameMaker> maker_;
};

// Names of the devices, as Device::Options::select takes them: one a worker.
std::vector<std::string> workersOf(const UpscaleOptions& options) {
  std::vector<std::string> devices;
  if (options.devices == "all") {
    const size_t count = failingWith(ExitCode::device, [] { return Device::list().size(); });
    for (size_t i = 0; i < count; ++i) devices.push_back(std::to_string(i));
  } else if (!options.devices.empty()) {
    std::istringstream list(options.devices);
    for (std::string device; std::getline(list, device, ',');) {
      if (device.empty())
        throw Failure{ExitCode::usage, "--devices '" + options.devices + "' has an empty name between its commas."};
      if (std::find(devices.begin(), devices.end(), device) != devices.end())
        throw Failure{ExitCode::usage, "--devices '" + options.devices + "' names '" + device +
                                           "' twice; --jobs-per-device lets frames share a device."};
      devices.push_back(device);
    }
  } else {
    devices.push_back(options.device);
  }
  std::vector<std::string> workers;
  for (uint32_t job = 0; job < options.jobsPerDevice; ++job)
    workers.insert(workers.end(), devices.begin(), devices.end());
  return workers;
}

}  // namespace

void refuse(bool given, const char* option, const char* why) {
  if (given) throw Failure{ExitCode::usage, std::string(option) + " " + why};
}

bool isSequence(const UpscaleOptions& options) {
  if (FilePattern::mayBeMany(options.color) || (!options.aux.empty() && FilePattern::mayBeMany(options.aux)))
    return true;
  if (options.output.find("##") != std::string::npos && FilePattern::mayBeMany(options.output))
    throw Failure{ExitCode::usage, "--output '" + options.output + "' names many frames, but '" + options.color +
                                       "' is one file: put #### in the names of both."};
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

std::optional<SequencePlan> planMissing(const UpscaleOptions& options) {
  requireOutput(options.log, ".json", "--log");
  SequencePlan plan = planSequence(options);
  if (!plan.frames.empty()) return plan;
  SequenceReport(options, plan, {}).writeLog();
  if (!options.quiet) std::printf("%s: all %zu frames are there\n", plan.output.c_str(), plan.there.size());
  return {};
}

UpscaleInput openFirst(const UpscaleOptions& options, const SequencePlan& plan) {
  const auto isAlwaysSo = [&](const OpenedModel& opened) {
    return staysConstant(plan.frames.size(),
                         [&](size_t frame) { return hasConstants(plan.frames[frame].alone(options), opened); });
  };
  std::optional<Failure> first;
  for (const SequenceFrame& frame : plan.frames) try {
      stopIfInterrupted();
      return openInput(frame.alone(options), isAlwaysSo);
    } catch (const Failure& failure) {
      if (failure.code != ExitCode::input) throw;
      if (!first) first = failure;
    }
  throw Failure{ExitCode::input, "No frame can be read, the first: " + first->message};
}

void runSequence(const UpscaleOptions& options, const SequencePlan& plan, const UpscaleInput& first,
                 const std::function<std::unique_ptr<FrameMaker>()>& newMaker) {
  std::vector<Worker> workers;
  for (const std::string& device : workersOf(options)) workers.emplace_back(device, options.quiet, newMaker());
  for (Worker& worker : workers) worker.open();

  const LineThreads threads = threadsFor(workers.size(), std::thread::hardware_concurrency());
  if (first.frame.layers() && !options.quiet) std::fputs(layersText(first.frame.layers()->list()).c_str(), stdout);
  SequenceReport report(options, plan, threads);
  std::mutex warning;
  const auto warn = [&](size_t index, const std::vector<std::string>& warnings) {
    const std::lock_guard lock(warning);
    report.warn(plan.frames[index].number, warnings);
  };
  TemporalFrames frames(options, first.opened, plan, threads.readers);
  const LineStages<FrameGroup, MadeFrame> stages{
      .read = [&](size_t index) -> std::optional<FrameGroup> {
        const SequenceFrame& frame = plan.frames[index];
        if (options.skipExisting && isMade(frame)) return {};
        FrameGroup read = frames.read(frame);
        if (options.skipExisting && mergedWithout(frame) == describeFrames(read.unreadable)) return {};
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

}  // namespace xrds
