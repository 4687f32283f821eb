#include "engine/recording.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <tuple>

#include "engine/handles.h"
#include "engine/hazards.h"
#include "engine/vulkan_result.h"
#include "engine/work.h"

namespace xrds {
namespace {

using ViewKey = std::tuple<VkBuffer, uint64_t, uint64_t, VkFormat>;

// Dispatches [begin, end) that are submitted together.
struct Submission {
  size_t begin = 0, end = 0;
  uint64_t work = 0;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  VkFence fence = VK_NULL_HANDLE;
};

ByteRange resolve(ByteRange range, BindingKind kind) {
  XRDS_CHECK(range.buffer != nullptr);
  XRDS_CHECK_EQ(range.byteOffset % (kind == BindingKind::copied ? 4 : kBindingAlignment), 0u);
  XRDS_CHECK_LT(range.byteOffset, range.buffer->byteSize());
  const uint64_t rest = range.buffer->byteSize() - range.byteOffset;
  if (range.byteSize == 0) range.byteSize = rest;
  XRDS_CHECK_LE(range.byteSize, rest);
  return range;
}

void checkBinding(const Gpu::Handles& gpu, const Binding& binding, const ByteRange& range) {
  if (binding.kind == BindingKind::copied) return;
  if (binding.kind == BindingKind::storage) {
    XRDS_CHECK_EQ(range.byteSize % 4, 0u);
    XRDS_CHECK_LE(range.byteSize, uint64_t{gpu.limits.maxStorageBufferRange});
    return;
  }
  const uint64_t texelBytes = 4 * byteSize(binding.type);
  XRDS_CHECK_EQ(range.byteSize % texelBytes, 0u);
  XRDS_CHECK_LE(range.byteSize / texelBytes, uint64_t{gpu.limits.maxTexelBufferElements});
  XRDS_CHECK(binding.access == Access::read);
}

void checkLimits(const Gpu::Handles& gpu, const PlacedDispatch& placed) {
  const Dispatch& dispatch = placed.dispatch;
  XRDS_CHECK_LE(dispatch.pushConstants.size(), size_t{kMaxPushConstantBytes});
  XRDS_CHECK_EQ(dispatch.pushConstants.size() % 4, 0u);
  for (size_t axis = 0; axis < 3; ++axis) {
    XRDS_CHECK_LT(0u, dispatch.groupCount[axis]);
    XRDS_CHECK_LE(dispatch.groupCount[axis], gpu.limits.maxComputeWorkGroupCount[axis]);
  }
  for (size_t i = 0; i < placed.ranges.size(); ++i) checkBinding(gpu, dispatch.bindings[i], placed.ranges[i]);
  if (!dispatch.isCopy()) return;
  XRDS_CHECK_EQ(placed.ranges.size(), 2u);
  XRDS_CHECK(dispatch.bindings[1].kind == BindingKind::copied && dispatch.bindings[1].access == Access::write);
  XRDS_CHECK_EQ(placed.ranges[0].byteSize, placed.ranges[1].byteSize);
}

// The texels of a range, and as many more as llvmpipe needs to take it for the same as all others (kVariantTexels).
uint64_t texelsOfOneVariant(uint64_t texels) {
  return alignUp(std::max(texels, kVariantTexels) - kVariantTexels, kVariantStep) + kVariantTexels;
}

void keepToOneVariant(const Gpu::Handles& gpu, PlacedDispatch& placed) {
  for (size_t i = 0; i < placed.ranges.size(); ++i) {
    const Binding& binding = placed.dispatch.bindings[i];
    const uint64_t texelBytes = 4 * byteSize(binding.type);
    const uint64_t texels = texelsOfOneVariant(placed.ranges[i].byteSize / texelBytes);
    if (isTexelBuffer(binding.kind) && texels <= gpu.limits.maxTexelBufferElements)
      placed.ranges[i].byteSize = texels * texelBytes;
  }
}

std::vector<RangeAccess> accessesOf(const PlacedDispatch& placed) {
  std::vector<RangeAccess> accesses;
  for (size_t i = 0; i < placed.ranges.size(); ++i) {
    const ByteRange& range = placed.ranges[i];
    accesses.push_back({.buffer = reinterpret_cast<uintptr_t>(range.buffer),
                        .byteOffset = range.byteOffset,
                        .byteSize = range.byteSize,
                        .access = placed.dispatch.bindings[i].access});
  }
  return accesses;
}

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

uint64_t workOf(const PlacedDispatch& placed) {
  uint64_t written = 0;
  for (size_t i = 0; i < placed.ranges.size(); ++i)
    if (placed.dispatch.bindings[i].access == Access::write) written += placed.ranges[i].byteSize;
  return xrds::workOf(placed.dispatch.multiplyAdds, written);
}

std::vector<Submission> cut(std::span<const PlacedDispatch> dispatches, uint64_t multiplyAddsPerSubmission) {
  std::vector<Submission> submissions;
  uint64_t held = 0;
  for (size_t i = 0; i < dispatches.size(); ++i) {
    const uint64_t work = workOf(dispatches[i]);
    if (submissions.empty() || held + work > multiplyAddsPerSubmission) {
      submissions.push_back({.begin = i});
      held = 0;
    }
    held += work;
    submissions.back().work = held;
    submissions.back().end = i + 1;
  }
  return submissions;
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
  explicit Handles(Gpu::Handles& owner) : gpu(owner) {}
  ~Handles();
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;

  void makePools(std::span<const PlacedDispatch> dispatches, bool timestamps);
  void recordAll();
  void release();
  void keepPace();
  VkBufferView viewOf(const ByteRange& range, VkFormat format);
  VkDescriptorSet describe(const PlacedDispatch& placed, VkDescriptorSetLayout layout);
  void barrierBetween(VkCommandBuffer commands) const;
  void recordCopy(VkCommandBuffer commands, const PlacedDispatch& placed) const;
  void record(Submission& submission, std::span<const PlacedDispatch> dispatches);
  uint32_t firstQuery(const Submission& submission) const;
  void readTimestamps();
  void submit(const Submission& submission);

  Gpu::Handles& gpu;
  VkCommandPool commandPool = VK_NULL_HANDLE;
  VkDescriptorPool descriptorPool = VK_NULL_HANDLE;
  VkQueryPool queryPool = VK_NULL_HANDLE;
  std::map<ViewKey, VkBufferView> views;
  RecordingOptions options;
  std::vector<PlacedDispatch> dispatches;
  uint64_t workPerSubmission = 0;
  std::vector<bool> barriers;
  std::vector<Submission> submissions;
  std::vector<double> gpuMicroseconds;
};

Recording::Handles::~Handles() { release(); }

void Recording::Handles::release() {
  if (gpu.abandoned) return;
  for (const Submission& submission : submissions) gpu.vk.vkDestroyFence(gpu.device, submission.fence, nullptr);
  for (const auto& [key, view] : views) gpu.vk.vkDestroyBufferView(gpu.device, view, nullptr);
  gpu.vk.vkDestroyQueryPool(gpu.device, queryPool, nullptr);
  gpu.vk.vkDestroyDescriptorPool(gpu.device, descriptorPool, nullptr);
  gpu.vk.vkDestroyCommandPool(gpu.device, commandPool, nullptr);
  submissions.clear();
  views.clear();
  queryPool = VK_NULL_HANDLE;
  descriptorPool = VK_NULL_HANDLE;
  commandPool = VK_NULL_HANDLE;
}

void Recording::Handles::recordAll() {
  workPerSubmission = workOfSubmission(gpu.pace, options.multiplyAddsPerSubmission);
  submissions = cut(dispatches, workPerSubmission);
  makePools(dispatches, options.timestamps);
  for (Submission& submission : submissions) record(submission, dispatches);
}

// What the device does in a submission's time may be far from what it was taken for.
void Recording::Handles::keepPace() {
  const uint64_t fitting = workOfSubmission(gpu.pace, options.multiplyAddsPerSubmission);
  if (fitting <= 2 * workPerSubmission && workPerSubmission <= 2 * fitting) return;
  release();
  recordAll();
}

void Recording::Handles::makePools(std::span<const PlacedDispatch> dispatches, bool timestamps) {
  VkCommandPoolCreateInfo commands{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  commands.queueFamilyIndex = gpu.queueFamily;
  checkResult(gpu.vk.vkCreateCommandPool(gpu.device, &commands, nullptr, &commandPool), "vkCreateCommandPool");

  uint32_t storages = 0, texels = 0;
  for (const auto& placed : dispatches)
    for (const Binding& binding : placed.dispatch.bindings) {
      storages += binding.kind == BindingKind::storage;
      texels += isTexelBuffer(binding.kind);
    }
  // One more of each, because a pool of zero is not allowed.
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, storages + 1},
                                        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, texels + 1}};
  VkDescriptorPoolCreateInfo descriptors{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  descriptors.maxSets = static_cast<uint32_t>(dispatches.size());
  descriptors.poolSizeCount = 2;
  descriptors.pPoolSizes = sizes;
  checkResult(gpu.vk.vkCreateDescriptorPool(gpu.device, &descriptors, nullptr, &descriptorPool),
              "vkCreateDescriptorPool");

  if (!timestamps || gpu.timestampValidBits == 0) return;
  VkQueryPoolCreateInfo queries{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
  queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
  queries.queryCount = static_cast<uint32_t>(dispatches.size() + submissions.size());
  checkResult(gpu.vk.vkCreateQueryPool(gpu.device, &queries, nullptr, &queryPool), "vkCreateQueryPool");
}

VkBufferView Recording::Handles::viewOf(const ByteRange& range, VkFormat format) {
  const VkBuffer buffer = range.buffer->handles().buffer;
  VkBufferView& view = views[{buffer, range.byteOffset, range.byteSize, format}];
  if (view) return view;
  VkBufferViewCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
  info.buffer = buffer;
  info.format = format;
  info.offset = range.byteOffset;
  info.range = range.byteSize;
  checkResult(gpu.vk.vkCreateBufferView(gpu.device, &info, nullptr, &view), "vkCreateBufferView");
  return view;
}

VkDescriptorSet Recording::Handles::describe(const PlacedDispatch& placed, VkDescriptorSetLayout layout) {
  const VkDescriptorSet set = allocateSet(gpu, descriptorPool, layout);
  const size_t count = placed.ranges.size();
  std::vector<VkDescriptorBufferInfo> buffers(count);
  std::vector<VkBufferView> texels(count);
  std::vector<VkWriteDescriptorSet> writes(count, {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET});
  for (size_t i = 0; i < count; ++i) {
    const ByteRange& range = placed.ranges[i];
    const Binding& binding = placed.dispatch.bindings[i];
    writes[i].dstSet = set;
    writes[i].dstBinding = static_cast<uint32_t>(i);
    writes[i].descriptorCount = 1;
    writes[i].descriptorType = descriptorTypeOf(binding.kind);
    if (isTexelBuffer(binding.kind)) {
      texels[i] = viewOf(range, texelFormatOf(binding.type, binding.kind));
      writes[i].pTexelBufferView = &texels[i];
    } else {
      buffers[i] = {range.buffer->handles().buffer, range.byteOffset, range.byteSize};
      writes[i].pBufferInfo = &buffers[i];
    }
  }
  gpu.vk.vkUpdateDescriptorSets(gpu.device, static_cast<uint32_t>(count), writes.data(), 0, nullptr);
  return set;
}

// Each submission has one timestamp before its first dispatch and one after each.
uint32_t Recording::Handles::firstQuery(const Submission& submission) const {
  return static_cast<uint32_t>(submission.begin + (&submission - submissions.data()));
}

void Recording::Handles::barrierBetween(VkCommandBuffer commands) const {
  constexpr VkPipelineStageFlags stages = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT |
                          VK_ACCESS_TRANSFER_WRITE_BIT;
  gpu.vk.vkCmdPipelineBarrier(commands, stages, stages, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

void Recording::Handles::recordCopy(VkCommandBuffer commands, const PlacedDispatch& placed) const {
  const ByteRange &from = placed.ranges[0], &to = placed.ranges[1];
  const VkBufferCopy region{from.byteOffset, to.byteOffset, from.byteSize};
  gpu.vk.vkCmdCopyBuffer(commands, from.buffer->handles().buffer, to.buffer->handles().buffer, 1, &region);
}

void Recording::Handles::record(Submission& submission, std::span<const PlacedDispatch> dispatches) {
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
  const auto stamp = [&](VkPipelineStageFlagBits stage) {
    if (queryPool) gpu.vk.vkCmdWriteTimestamp(commands, stage, queryPool, query++);
  };
  if (queryPool)
    gpu.vk.vkCmdResetQueryPool(commands, queryPool, query,
                               static_cast<uint32_t>(submission.end - submission.begin + 1));
  fullBarrier(gpu, commands);
  stamp(VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT);
  for (size_t i = submission.begin; i < submission.end; ++i) {
    // Dispatches that overlap would have each other's time.
    if ((barriers[i] || queryPool) && i > submission.begin) barrierBetween(commands);
    const Dispatch& dispatch = dispatches[i].dispatch;
    if (dispatch.isCopy()) {
      recordCopy(commands, dispatches[i]);
      stamp(VK_PIPELINE_STAGE_TRANSFER_BIT);
      continue;
    }
    const VkDescriptorSet set = describe(dispatches[i], gpu.pipelines.at(PipelineKey(dispatch)).setLayout);
    recordDispatch(gpu, commands, dispatch, set, dispatch.groupCount);
    stamp(VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT);
  }
  fullBarrier(gpu, commands);
  checkResult(gpu.vk.vkEndCommandBuffer(commands), "vkEndCommandBuffer");
}

void Recording::Handles::submit(const Submission& submission) {
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

Recording::Recording(Gpu& gpu, std::span<const PlacedDispatch> asked, RecordingOptions options)
    : handles_(std::make_unique<Handles>(gpu.handles())) {
  XRDS_CHECK_LT(0u, asked.size());
  std::vector<PlacedDispatch> dispatches(asked.begin(), asked.end());
  std::vector<std::vector<RangeAccess>> accesses;
  for (PlacedDispatch& placed : dispatches) {
    XRDS_CHECK_EQ(placed.ranges.size(), placed.dispatch.bindings.size());
    for (size_t i = 0; i < placed.ranges.size(); ++i)
      placed.ranges[i] = resolve(placed.ranges[i], placed.dispatch.bindings[i].kind);
    checkLimits(gpu.handles(), placed);
    if (gpu.description().kind == DeviceKind::cpu) keepToOneVariant(gpu.handles(), placed);
    accesses.push_back(accessesOf(placed));
  }
  std::vector<const Dispatch*> launches;
  launches.reserve(dispatches.size());
  for (const PlacedDispatch& placed : dispatches) launches.push_back(&placed.dispatch);
  compilePrograms(gpu, launches);
  handles_->barriers = barriersBefore(accesses);
  handles_->options = options;
  handles_->dispatches = std::move(dispatches);
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

size_t Recording::submissionCount() const { return handles_->submissions.size(); }
uint64_t Recording::largestSubmission() const {
  uint64_t most = 0;
  for (const Submission& submission : handles_->submissions) most = std::max(most, submission.work);
  return most;
}

size_t Recording::barrierCount() const {
  return static_cast<size_t>(std::count(handles_->barriers.begin(), handles_->barriers.end(), true));
}

}  // namespace xrds
