// Compiles programs for drivers that do it at the first dispatch (llvmpipe: 0.1 to 1 s each, one after the other).
#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <map>
#include <mutex>

#include "engine/drivers/vulkan_result.h"
#include "engine/handles.h"
#include "engine/pipelines/preparation.h"
#include "xrds/error.h"

namespace xrds {
namespace {

/// Dispatches without workgroups: they compute nothing, but make such a driver compile. Its program must not depend on
/// the memory that is bound, and does not: see kVariantTexels.
class EmptyDispatches {
 public:
  explicit EmptyDispatches(Gpu& gpu) : gpu_(gpu.handles()), scratch_(gpu, kBindingAlignment) {}
  ~EmptyDispatches() { reset(); }
  EmptyDispatches(const EmptyDispatches&) = delete;
  EmptyDispatches& operator=(const EmptyDispatches&) = delete;

  /// Returns once the program is compiled.
  void run(const Dispatch& dispatch);

 private:
  VkDescriptorSet describe(const Dispatch& dispatch, VkDescriptorSetLayout layout);
  VkBufferView viewOf(const Binding& binding);
  void reset();

  Gpu::Handles& gpu_;
  Buffer scratch_;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  std::vector<VkBufferView> views_;
};

void EmptyDispatches::reset() {
  if (gpu_.abandoned) return;
  for (const VkBufferView view : views_) gpu_.vk.vkDestroyBufferView(gpu_.device, view, nullptr);
  views_.clear();
  gpu_.vk.vkDestroyDescriptorPool(gpu_.device, pool_, nullptr);
  pool_ = VK_NULL_HANDLE;
}

VkBufferView EmptyDispatches::viewOf(const Binding& binding) {
  VkBufferViewCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
  info.buffer = scratch_.handles().buffer;
  info.format = texelFormatOf(binding.type, binding.kind);
  info.range = std::min(kVariantTexels, uint64_t{gpu_.limits.maxTexelBufferElements}) * 4 * byteSize(binding.type);
  checkResult(gpu_.vk.vkCreateBufferView(gpu_.device, &info, nullptr, &views_.emplace_back()), "vkCreateBufferView");
  return views_.back();
}

VkDescriptorSet EmptyDispatches::describe(const Dispatch& dispatch, VkDescriptorSetLayout layout) {
  const auto count = static_cast<uint32_t>(dispatch.bindings.size());
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, count},
                                        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, count}};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = 1;
  pool.poolSizeCount = 2;
  pool.pPoolSizes = sizes;
  checkResult(gpu_.vk.vkCreateDescriptorPool(gpu_.device, &pool, nullptr, &pool_), "vkCreateDescriptorPool");
  const VkDescriptorSet set = allocateSet(gpu_, pool_, layout);
  for (uint32_t i = 0; i < count; ++i) {
    const Binding& binding = dispatch.bindings[i];
    const VkDescriptorBufferInfo buffer{scratch_.handles().buffer, 0, kBindingAlignment};
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = set;
    write.dstBinding = i;
    write.descriptorCount = 1;
    write.descriptorType = descriptorTypeOf(binding.kind);
    write.pBufferInfo = &buffer;
    VkBufferView view = VK_NULL_HANDLE;
    if (isTexelBuffer(binding.kind)) view = viewOf(binding);
    write.pTexelBufferView = &view;
    gpu_.vk.vkUpdateDescriptorSets(gpu_.device, 1, &write, 0, nullptr);
  }
  return set;
}

void EmptyDispatches::run(const Dispatch& dispatch) {
  const VkDescriptorSet set = describe(dispatch, gpu_.pipelines.at(PipelineKey(dispatch)).setLayout);
  runOnce(gpu_, [&](VkCommandBuffer commands) { recordDispatch(gpu_, commands, dispatch, set, {0, 0, 0}); });
  reset();
}

// Devices beside the first, each with a queue of its own; fewer if they cannot be opened. Without a cache folder what
// they compile would be lost.
std::vector<Gpu> openMore(Gpu& gpu, size_t count) {
  DeviceOptions options = gpu.handles().options;
  options.select = gpu.description().uuid;
  options.validation = false;
  options.onPreparation = nullptr;
  std::vector<Gpu> devices;
  if (options.cacheFolder.empty() || gpu.isShared()) return devices;  // they might have vectors of another width
  try {
    while (devices.size() < count) devices.emplace_back(options);
  } catch (const std::exception&) {  // then those that there are do it
  }
  return devices;
}

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Programs to compile, of which each thread takes the next one.
struct Programs {
  std::vector<const Dispatch*> dispatches{};
  std::atomic<size_t> next = 0;

  const Dispatch* take() {
    const size_t i = next++;
    return i < dispatches.size() ? dispatches[i] : nullptr;
  }
};

void compileOnAnother(Gpu& gpu, Programs& programs, PreparationReport& report) {
  try {
    EmptyDispatches empty(gpu);
    while (const Dispatch* dispatch = report.cancelled() ? nullptr : programs.take()) {
      const PipelineKey key(*dispatch);
      makePipelines(gpu.handles(), {&key, 1});
      empty.run(*dispatch);
      report.advance();
    }
  } catch (const std::exception&) {  // then the first dispatch compiles it
  }
}

// Compiles the programs of pipelines that are made. Those that a caller who cancels leaves out lose theirs, so that the
// next preparation compiles them.
void compileMade(Gpu& gpu, EmptyDispatches& empty, Programs& programs) {
  constexpr size_t kMostDevices = 8;  // each takes 30 ms to open
  const size_t count = programs.dispatches.size();
  if (count == 0) return;
  PreparationReport report(gpu.handles().options.onPreparation, Preparation::Phase::machineCode, count);
  const size_t wanted = std::clamp<size_t>(std::thread::hardware_concurrency(), 1, std::min(kMostDevices, count));
  std::vector<Gpu> more = openMore(gpu, wanted - 1);
  std::exception_ptr failure;
  const auto work = [&](size_t thread) {
    if (thread > 0) return compileOnAnother(more[thread - 1], programs, report);
    try {
      while (const Dispatch* dispatch = report.cancelled() ? nullptr : programs.take()) {
        empty.run(*dispatch);
        report.advance();
      }
    } catch (...) {
      failure = std::current_exception();
    }
  };
  try {
    report.await(1 + more.size(), work);
  } catch (const Cancelled&) {
    while (const Dispatch* dispatch = programs.take()) forgetPipeline(gpu.handles(), PipelineKey(*dispatch));
    throw;
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

// Of programs in the disk cache, which come from it in 1 to 3 ms, each is compiled as soon as its pipeline is made: the
// queue then works beside the threads that make the others. Once that has taken time, they are not cached. A queue
// compiles one program at a time, so further devices lend their queues; what they compile reaches the first device
// through the driver's disk cache, which an instance completes before it is destroyed.
void makeCompiledPipelines(Gpu& gpu, std::span<const Dispatch* const> dispatches) {
  constexpr double kSecondsIfCached = 0.2;
  if (dispatches.empty()) return;
  std::map<PipelineKey, const Dispatch*> waiting;
  std::vector<PipelineKey> keys;
  for (const Dispatch* dispatch : dispatches) waiting.emplace(keys.emplace_back(*dispatch), dispatch);
  EmptyDispatches empty(gpu);
  std::mutex access;  // to all of these
  double seconds = 0;
  std::exception_ptr failure;  // of a dispatch, which may still hold its pipeline: not that of making it
  makePipelines(gpu.handles(), keys, [&](const PipelineKey& key) {
    const std::lock_guard lock(access);
    if (failure || seconds > kSecondsIfCached) return;
    const auto start = std::chrono::steady_clock::now();
    try {
      empty.run(*waiting.at(key));
    } catch (...) {
      failure = std::current_exception();
    }
    waiting.erase(key);
    seconds += secondsSince(start);
  });
  if (failure) std::rethrow_exception(failure);

  Programs programs;
  for (const auto& [key, dispatch] : waiting) programs.dispatches.push_back(dispatch);
  compileMade(gpu, empty, programs);
}

}  // namespace xrds
