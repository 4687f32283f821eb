#include "viewer/upscaling/upscaling.h"

#include <utility>

#include "app/failing_with.h"
#include "xrds/error.h"

namespace xrds {
namespace fs = std::filesystem;

namespace {

constexpr auto kPollPeriod = std::chrono::milliseconds(50);

}  // namespace

Upscaling::Upscaling(VulkanDevice& vulkan, Device& device, Pictures& pictures, std::function<void()> changed)
    : vulkan_(vulkan), device_(device), pictures_(pictures), changed_(std::move(changed)) {
  report_.device = device.description().name;
  report_.settled = true;
  thread_ = std::thread([this] { loop(); });
}

Upscaling::~Upscaling() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

bool Upscaling::stop(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  stopping_ = true;
  wake_.notify_all();
  wake_.wait(lock, [this] { return !saving_; });
  const auto until = std::chrono::steady_clock::now() + patience;
  if (!wake_.wait_until(lock, until, [this] { return ended_; })) return false;
  return !measuring_.valid() || measuring_.wait_until(until) == std::future_status::ready;
}

void Upscaling::want(const Wanted& wanted) {
  {
    const std::lock_guard lock(mutex_);
    if (wanted == wanted_) return;
    wanted_ = wanted;
    report_.settled = report_.current = false;
    ++asked_;
  }
  wake_.notify_all();
}

void Upscaling::save(const fs::path& path) {
  {
    const std::lock_guard lock(mutex_);
    saveTo_ = path;
    report_.settled = false;
  }
  wake_.notify_all();
}

Report Upscaling::report() const {
  const std::lock_guard lock(mutex_);
  return report_;
}

void Upscaling::fail(const Failure& failure) {
  tell([&](Report& report) {
    report.error = failure.message;
    report.failure = failure.code;
  });
}

void Upscaling::note(const std::string& notice) {
  tell([&](Report& report) { report.notice = notice; });
}

void Upscaling::tell(const std::function<void(Report&)>& change) {
  {
    const std::lock_guard lock(mutex_);
    change(report_);
  }
  changed_();
}

bool Upscaling::stopping() const {
  const std::lock_guard lock(mutex_);
  return stopping_;
}

bool Upscaling::outdated() const {
  const std::lock_guard lock(mutex_);
  return stopping_ || asked_ != serving_;
}

void Upscaling::loop() {
  while (const std::optional<Wanted> wanted = nextWanted()) {
    try {
      serve(*wanted);
    } catch (const Cancelled&) {  // something else is wanted by now, or the end
    } catch (const Error& failure) {
      tellFailure(*wanted, {ExitCode::device, failure.what()});
    } catch (...) {
      tellFailure(*wanted, failureOf(std::current_exception()));
    }
  }
  const std::lock_guard lock(mutex_);
  ended_ = true;
  wake_.notify_all();
}

// Waits for something to do; nothing: the end.
std::optional<Wanted> Upscaling::nextWanted() {
  std::unique_lock lock(mutex_);
  const auto woken = [&] { return stopping_ || refining_ || asked_ != serving_ || !saveTo_.empty(); };
  if (wanted_.watching || measuring_.valid())
    wake_.wait_for(lock, kPollPeriod, woken);
  else
    wake_.wait(lock, woken);
  if (stopping_) return std::nullopt;
  serving_ = asked_;
  return wanted_;
}

void Upscaling::tellFailure(const Wanted& wanted, const Failure& failure) {
  refining_ = false;
  // A file that is being written cannot be read; the next look at it may find it whole.
  const auto place = wanted.watching ? &Report::waiting : &Report::error;
  if (const Report now = report(); now.*place == failure.message && now.settled) return;
  tell([&](Report& report) {
    report.*place = failure.message;
    report.failure = failure.code;
    if (!wanted.watching) report.waiting.clear();
    report.share = 1;
    report.settled = report.current = asked_ == serving_;
    if (report.settled && !std::exchange(saveTo_, {}).empty()) report.notice = kNothingToSave;
  });
}

void Upscaling::serve(const Wanted& wanted) {
  clock_.begin();
  takeMetrics();
  if (std::exchange(temporal_, wanted.temporal) != wanted.temporal) {
    upscaled_ = false;
    flicker_.reset();  // of one kind of pictures alone
  }
  if (!wanted.live.scene.empty()) {
    trace(wanted);
  } else if (!wanted.files.colour.empty() || !wanted.folder.empty()) {
    live_.reset();
    refining_ = false;
    if (loadWanted(wanted)) upscaled_ = false;
    if (frame_) showChosen(wanted);
    if (outdated()) return;
  }
  saveIfAsked();
  const std::lock_guard lock(mutex_);
  const bool settled = asked_ == serving_ && saveTo_.empty() && !measuring_.valid() && !refining_;
  const bool current = asked_ == serving_ && saveTo_.empty();
  if (report_.settled == settled && report_.current == current) return;
  report_.settled = settled;
  report_.current = current;
  changed_();
}

void Upscaling::showChosen(const Wanted& wanted) {
  prepare(wanted);
  if (!upscaled_) upscale(wanted);
  if (!upscaled_ || outdated()) return;
  if (wanted.slots[static_cast<size_t>(Slot::flicker)] && !flicker_) showFlicker(wanted);  // begins with what is shown
  for (const Slot slot : {Slot::bicubic, Slot::demodulated, Slot::guided})
    if (wanted.slots[static_cast<size_t>(slot)] && (live_ || !pictures_.at(slot).valid)) makeBase(slot);
  showDenoised(wanted);
  if (wanted.metrics && frame_) startMetrics();
}

}  // namespace xrds
