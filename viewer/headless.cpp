#include "viewer/headless.h"

#include <algorithm>
#include <condition_variable>
#include <cstdio>

#include "app/exit_code.h"

namespace xrds {
namespace {

constexpr uint64_t kUncounted = 3;  // pictures in which networks are made ready and find their pace

/// Waits for what the worker has to tell.
class Signal {
 public:
  void give() {
    const std::lock_guard lock(mutex_);
    given_ = true;
    condition_.notify_one();
  }
  void await() {
    std::unique_lock lock(mutex_);
    condition_.wait(lock, [this] { return given_; });
    given_ = false;
  }

 private:
  std::mutex mutex_;
  std::condition_variable condition_;
  bool given_ = false;
};

/// The stages of several pictures.
class MeanTimes {
 public:
  void add(const std::vector<StageTime>& stages) {
    ++count_;
    for (const StageTime& stage : stages) {
      auto found =
          std::find_if(sums_.begin(), sums_.end(), [&](const StageTime& sum) { return sum.name == stage.name; });
      if (found == sums_.end()) found = sums_.insert(sums_.end(), {stage.name, 0, stage.isPart});
      found->milliseconds += stage.milliseconds;
    }
  }
  void print() const {
    for (const StageTime& sum : sums_)
      std::printf("  %-24s %9.2f ms\n", ((sum.isPart ? "  " : "") + sum.name).c_str(), sum.milliseconds / count_);
  }

 private:
  std::vector<StageTime> sums_;
  double count_ = 0;
};

void print(const Report& report, const MeanTimes& means, uint64_t pictures, double seconds) {
  std::printf("%s, %s %s: %u x %u to %u x %u\n", report.device.c_str(), report.model.c_str(),
              precisionName(report.fp16), report.width, report.height, report.scale * report.width,
              report.scale * report.height);
  means.print();
  std::printf("pictures %llu in %.2f s, %.2f a second\n", static_cast<unsigned long long>(pictures), seconds,
              static_cast<double>(pictures) / seconds);
}

}  // namespace

void runHeadless(const ViewerOptions& options) {
  if (options.scene.empty() || options.frames <= 0)
    throw Failure{ExitCode::usage, "--headless needs --live SCENE and --frames N."};
  using Clock = std::chrono::steady_clock;
  Wanted wanted = wantedOf(options);
  VulkanDevice vulkan({.select = options.device});
  Device device = vulkan.shared();
  Pictures pictures(vulkan);
  wanted.live.scene = options.scene;
  wanted.temporal = isTemporal(options, true);
  Signal signal;
  Upscaling upscaling(vulkan, device, pictures, [&] { signal.give(); });
  upscaling.want(wanted);
  std::optional<Orbit> orbit;
  const uint64_t last = kUncounted + static_cast<uint64_t>(options.frames);
  Clock::time_point start{};
  MeanTimes means;
  for (uint64_t seen = 0; seen < last;) {
    signal.await();
    const Report report = upscaling.report();
    if (!report.error.empty()) throw Failure{report.failure, report.error};
    if (!orbit && report.scene == options.scene) orbit.emplace(report.startCamera);
    if (!orbit || report.pictures == seen) continue;
    seen = report.pictures;
    if (seen <= kUncounted)
      start = Clock::now();
    else
      means.add(report.stages);
    orbit->turn(0.02F, 0);
    wanted.live.camera = orbit->camera();
    upscaling.want(wanted);
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  print(upscaling.report(), means, last - kUncounted, seconds);
}

}  // namespace xrds
