#include "engine/recording.h"

#include <algorithm>
#include <chrono>
#include <set>

#include "engine/drivers/vulkan_result.h"
#include "engine/recorder.h"

namespace xrds {
namespace {

struct Submission : WorkPiece {
  VkCommandBuffer commands = VK_NULL_HANDLE;
  VkFence fence = VK_NULL_HANDLE;
};

// One dispatch for each pipeline that is still to be made.
std::vector<const Dispatch*> notMade(const Gpu::Handles& gpu, std::span<const Dispatch* const> dispatches) {
  std::set<PipelineKey> found;
  std::vector<const Dispatch*> fresh;
  for (const Dispatch* dispatch : dispatches)
    if (const PipelineKey key(*dispatch);
        !dispatch->isCopy() && !gpu.pipelines.contains(key) && found.insert(key).second)
      fresh.push_back(dispatch);
  return fresh;
}

std::vector<PipelineKey> keysOf(std::span<const Dispatch* const> dispatches) {
  std::vector<PipelineKey> keys;
  for (const Dispatch* dispatch : dispatches) keys.emplace_back(*dispatch);
  return keys;
}

/// Takes the time from one submission's end to the next. The last one of a run may be a remainder too small to tell.
class PaceMeter {
 public:
  void finished(uint64_t work) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    work_ += static_cast<double>(work);
    seconds_ += seconds;
    if (work < kLeast || seconds <= 0) return;
    const double pace = static_cast<double>(work) / seconds;
    if (slowest_ == 0 || pace < slowest_) slowest_ = pace;
  }
  Pace paceAfter(const Pace& before) const { return measured(before, work_, seconds_, slowest_); }

 private:
  static constexpr uint64_t kLeast = uint64_t{1} << 24;  // of less, the submission itself shows
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  double work_ = 0, seconds_ = 0, slowest_ = 0;
};

}  // namespace

struct Recording::Handles {
  Handles(Gpu& owner, std::span<const PlacedDispatch> dispatches, const RecordingOptions& asked)
      : gpu(owner.handles()), recorder(owner, dispatches), options(asked) {}
  ~Handles();
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;

  void makePools();
  void recordAll();
  void release();
  void keepPace();
  void record(Submission& submission);
  uint32_t firstQuery(const Submission& submission) const;
  void readTimestamps();
  void submit(const Submission& submission);

  Gpu::Handles& gpu;
  Recorder recorder;
  RecordingOptions options;
  VkCommandPool commandPool = VK_NULL_HANDLE;
  VkQueryPool queryPool = VK_NULL_HANDLE;
  uint64_t workPerSubmission = 0;
  std::vector<Submission> submissions;
  std::vector<double> gpuMicroseconds;
};

Recording::Handles::~Handles() { release(); }

void Recording::Handles::release() {
  if (gpu.abandoned) return;
  for (const Submission& submission : submissions) gpu.vk.vkDestroyFence(gpu.device, submission.fence, nullptr);
  gpu.vk.vkDestroyQueryPool(gpu.device, queryPool, nullptr);
  gpu.vk.vkDestroyCommandPool(gpu.device, commandPool, nullptr);
  submissions.clear();
  queryPool = VK_NULL_HANDLE;
  commandPool = VK_NULL_HANDLE;
}

void Recording::Handles::recordAll() {
  workPerSubmission = workOfSubmission(gpu.pace, options.multiplyAddsPerSubmission);
  for (const WorkPiece& piece : cutWork(recorder.dispatches(), workPerSubmission)) submissions.push_back({piece});
  makePools();
  for (Submission& submission : submissions) record(submission);
}

// What the device does in a submission's time may be far from what it was taken for.
void Recording::Handles::keepPace() {
  const uint64_t fitting = workOfSubmission(gpu.pace, options.multiplyAddsPerSubmission);
  if (fitting <= 2 * workPerSubmission && workPerSubmission <= 2 * fitting) return;
  release();
  recordAll();
}

void Recording::Handles::makePools() {
  VkCommandPoolCreateInfo commands{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  commands.queueFamilyIndex = gpu.queueFamily;
  checkResult(gpu.vk.vkCreateCommandPool(gpu.device, &commands, nullptr, &commandPool), "vkCreateCommandPool");
  if (!options.timestamps || gpu.timestampValidBits == 0) return;
  VkQueryPoolCreateInfo queries{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
  queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
  queries.queryCount = static_cast<uint32_t>(recorder.dispatches().size() + submissions.size());
  checkResult(gpu.vk.vkCreateQueryPool(gpu.device, &queries, nullptr, &queryPool), "vkCreateQueryPool");
}

// Each submission has one timestamp before its first dispatch and one after each.
uint32_t Recording::Handles::firstQuery(const Submission& submission) const {
  return static_cast<uint32_t>(submission.begin + (&submission - submissions.data()));
}

void Recording::Handles::record(Submission& submission) {
  VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  info.commandPool = commandPool;
  info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  info.commandBufferCount = 1;
  checkResult(gpu.vk.vkAllocateCommandBuffers(gpu.device, &info, &submission.commands), "vkAllocateCommandBuffers");
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  checkResult(gpu.vk.vkCreateFence(gpu.device, &fence, nullptr, &submission.fence), "vkCreateFence");

  const VkCommandBuffer commands = submission.commands;
  const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  checkResult(gpu.vk.vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
  uint32_t query = firstQuery(submission);
  std::function<void(VkPipelineStageFlagBits)> stamp;
  if (queryPool) {
    stamp = [&](VkPipelineStageFlagBits stage) { gpu.vk.vkCmdWriteTimestamp(commands, stage, queryPool, query++); };
    gpu.vk.vkCmdResetQueryPool(commands, queryPool, query,
                               static_cast<uint32_t>(submission.end - submission.begin + 1));
  }
  fullBarrier(gpu, commands);
  if (stamp) stamp(VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT);
  recorder.record(commands, submission.begin, submission.end, stamp);
  fullBarrier(gpu, commands);
  checkResult(gpu.vk.vkEndCommandBuffer(commands), "vkEndCommandBuffer");
}

void Recording::Handles::submit(const Submission& submission) {
  requireAnswering(gpu);
  checkResult(gpu.vk.vkResetFences(gpu.device, 1, &submission.fence), "vkResetFences");
  VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  info.commandBufferCount = 1;
  info.pCommandBuffers = &submission.commands;
  submitToQueue(gpu, info, submission.fence);
}

/// Submissions in flight. Those that are left after a failure are waited for, so that nothing which the device still
/// uses is destroyed.
class Recording::Flight {
 public:
  explicit Flight(Handles& recording) : recording_(recording) {}
  ~Flight() {
    try {
      while (waiting() && !recording_.gpu.abandoned) finishOne();
    } catch (const std::exception&) {  // the device is lost: it uses nothing any more
    }
  }
  Flight(const Flight&) = delete;
  Flight& operator=(const Flight&) = delete;

  size_t submitted() const { return submitted_; }
  size_t finished() const { return finished_; }
  bool waiting() const { return finished_ < submitted_; }
  void submitOne() { recording_.submit(recording_.submissions[submitted_]), ++submitted_; }
  void finishOne() { awaitFence(recording_.gpu, recording_.submissions[finished_].fence), ++finished_; }

 private:
  Handles& recording_;
  size_t submitted_ = 0, finished_ = 0;
};

void Recording::Handles::readTimestamps() {
  const uint64_t mask = gpu.timestampValidBits >= 64 ? ~uint64_t{0} : (uint64_t{1} << gpu.timestampValidBits) - 1;
  for (const Submission& submission : submissions) {
    std::vector<uint64_t> ticks(submission.end - submission.begin + 1);
    checkResult(gpu.vk.vkGetQueryPoolResults(gpu.device, queryPool, firstQuery(submission),
                                             static_cast<uint32_t>(ticks.size()), ticks.size() * 8, ticks.data(), 8,
                                             VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
                "vkGetQueryPoolResults");
    for (size_t i = 1; i < ticks.size(); ++i)
      gpuMicroseconds.push_back(static_cast<double>((ticks[i] - ticks[i - 1]) & mask) *
                                static_cast<double>(gpu.limits.timestampPeriod) / 1000);
  }
}

void compilePrograms(Gpu& gpu, std::span<const Dispatch* const> dispatches) {
  const std::vector<const Dispatch*> fresh = notMade(gpu.handles(), dispatches);
  if (gpu.description().kind == DeviceKind::cpu)
    makeCompiledPipelines(gpu, fresh);
  else
    makePipelines(gpu.handles(), keysOf(fresh));
}

Recording::Recording(Gpu& gpu, std::span<const PlacedDispatch> dispatches, RecordingOptions options)
    : handles_(std::make_unique<Handles>(gpu, dispatches, options)) {
  handles_->recordAll();
}

Recording::~Recording() = default;
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;

bool Recording::run(const std::function<bool(size_t, size_t)>& progress) {
  handles_->keepPace();
  const auto& submissions = handles_->submissions;
  handles_->gpuMicroseconds.clear();
  // Two are in flight, so that the device has work while the host turns around. On a CPU that takes microseconds, and
  // who else waits for the queue, such as a drawing, waits half as long.
  const size_t most = handles_->gpu.description.kind == DeviceKind::cpu ? 1 : 2;
  Flight flight(*handles_);
  PaceMeter meter;
  bool stopped = false;
  while (flight.waiting() || (flight.submitted() < submissions.size() && !stopped)) {
    while (!stopped && flight.submitted() < submissions.size() && flight.submitted() < flight.finished() + most)
      flight.submitOne();
    flight.finishOne();
    meter.finished(submissions[flight.finished() - 1].work);
    if (progress && !stopped) stopped = !progress(flight.finished(), submissions.size());
  }
  if (handles_->options.measuresPace) handles_->gpu.pace = meter.paceAfter(handles_->gpu.pace);
  if (flight.finished() < submissions.size()) return false;
  if (handles_->queryPool) handles_->readTimestamps();
  return !stopped;
}

std::vector<double> Recording::gpuMicroseconds() const { return handles_->gpuMicroseconds; }

size_t Recording::barrierCount() const {
  return static_cast<size_t>(
      std::count(handles_->recorder.barriers().begin(), handles_->recorder.barriers().end(), true));
}

}  // namespace xrds
