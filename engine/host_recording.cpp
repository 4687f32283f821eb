#include "engine/host_recording.h"

#include "engine/drivers/vulkan_result.h"
#include "engine/recorder.h"

namespace xrds {

struct HostRecording::Handles {
  Handles(Gpu& owner, std::span<const PlacedDispatch> dispatches) : gpu(owner.handles()), recorder(owner, dispatches) {}
  ~Handles() {
    if (!gpu.abandoned) gpu.vk.vkDestroyCommandPool(gpu.device, pool, nullptr);
  }
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;

  VkCommandBuffer begun(VkCommandBufferLevel level);
  VkCommandBuffer recorded(VkCommandBufferLevel level, size_t begin, size_t end);

  Gpu::Handles& gpu;
  Recorder recorder;
  VkCommandPool pool = VK_NULL_HANDLE;
  VkCommandBuffer whole = VK_NULL_HANDLE;
  std::vector<VkCommandBuffer> pieces;
};

namespace {

// Between the program's own work, which may be anything, and the dispatches.
void barrierToHost(const Gpu::Handles& gpu, VkCommandBuffer commands, bool isBefore) {
  constexpr VkPipelineStageFlags kOurs = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                                 kTheirs = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
  constexpr VkAccessFlags kOurWrites = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
                          kOurAccess = kOurWrites | VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT,
                          kAnyWrite = VK_ACCESS_MEMORY_WRITE_BIT, kAnyAccess = kAnyWrite | VK_ACCESS_MEMORY_READ_BIT;
  VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  barrier.srcAccessMask = isBefore ? kAnyWrite : kOurWrites;
  barrier.dstAccessMask = isBefore ? kOurAccess : kAnyAccess;
  gpu.vk.vkCmdPipelineBarrier(commands, isBefore ? kTheirs : kOurs, isBefore ? kOurs : kTheirs, 0, 1, &barrier, 0,
                              nullptr, 0, nullptr);
}

struct Points {
  explicit Points(std::span<const TimelinePoint> points) {
    for (const TimelinePoint& point : points) {
      semaphores.push_back(point.semaphore);
      values.push_back(point.value);
    }
    stages.assign(points.size(), VK_PIPELINE_STAGE_ALL_COMMANDS_BIT);
  }
  uint32_t count() const { return static_cast<uint32_t>(values.size()); }
  std::vector<VkSemaphore> semaphores;
  std::vector<uint64_t> values;
  std::vector<VkPipelineStageFlags> stages;
};

}  // namespace

VkCommandBuffer HostRecording::Handles::begun(VkCommandBufferLevel level) {
  VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  info.commandPool = pool;
  info.level = level;
  info.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  checkResult(gpu.vk.vkAllocateCommandBuffers(gpu.device, &info, &commands), "vkAllocateCommandBuffers");
  const VkCommandBufferInheritanceInfo inherited{VK_STRUCTURE_TYPE_COMMAND_BUFFER_INHERITANCE_INFO};
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_SIMULTANEOUS_USE_BIT;
  begin.pInheritanceInfo = &inherited;
  checkResult(gpu.vk.vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
  return commands;
}

VkCommandBuffer HostRecording::Handles::recorded(VkCommandBufferLevel level, size_t first, size_t end) {
  const VkCommandBuffer commands = begun(level);
  barrierToHost(gpu, commands, true);
  recorder.record(commands, first, end);
  barrierToHost(gpu, commands, false);
  checkResult(gpu.vk.vkEndCommandBuffer(commands), "vkEndCommandBuffer");
  return commands;
}

HostRecording::HostRecording(Gpu& gpu, std::span<const PlacedDispatch> dispatches)
    : handles_(std::make_unique<Handles>(gpu, dispatches)) {
  Handles& made = *handles_;
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.queueFamilyIndex = made.gpu.queueFamily;
  checkResult(made.gpu.vk.vkCreateCommandPool(made.gpu.device, &pool, nullptr, &made.pool), "vkCreateCommandPool");
  made.whole = made.recorded(VK_COMMAND_BUFFER_LEVEL_SECONDARY, 0, made.recorder.dispatches().size());
  const uint64_t most = workOfSubmission(made.gpu.pace, RecordingOptions{}.multiplyAddsPerSubmission);
  for (const WorkPiece& piece : cutWork(made.recorder.dispatches(), most))
    made.pieces.push_back(made.recorded(VK_COMMAND_BUFFER_LEVEL_PRIMARY, piece.begin, piece.end));
}

HostRecording::~HostRecording() = default;

void HostRecording::recordInto(VkCommandBuffer commands) const {
  handles_->gpu.vk.vkCmdExecuteCommands(commands, 1, &handles_->whole);
}

void HostRecording::submit(std::span<const TimelinePoint> waits, std::span<const TimelinePoint> signals) {
  const Points before(waits), after(signals);
  VkTimelineSemaphoreSubmitInfo values{VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO};
  values.waitSemaphoreValueCount = before.count();
  values.pWaitSemaphoreValues = before.values.data();
  values.signalSemaphoreValueCount = after.count();
  values.pSignalSemaphoreValues = after.values.data();
  std::vector<VkSubmitInfo> submits(handles_->pieces.size(), {VK_STRUCTURE_TYPE_SUBMIT_INFO});
  for (size_t i = 0; i < submits.size(); ++i) {
    submits[i].commandBufferCount = 1;
    submits[i].pCommandBuffers = &handles_->pieces[i];
  }
  // Both may be the same one: then it names all the semaphores.
  VkTimelineSemaphoreSubmitInfo first = values, last = values;
  if (submits.size() > 1) {
    first.signalSemaphoreValueCount = 0;
    last.waitSemaphoreValueCount = 0;
  }
  submits.front().pNext = &first;
  submits.front().waitSemaphoreCount = before.count();
  submits.front().pWaitSemaphores = before.semaphores.data();
  submits.front().pWaitDstStageMask = before.stages.data();
  submits.back().pNext = &last;
  submits.back().signalSemaphoreCount = after.count();
  submits.back().pSignalSemaphores = after.semaphores.data();
  submitToQueue(handles_->gpu, submits, VK_NULL_HANDLE);
}

}  // namespace xrds
