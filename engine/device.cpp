#include "engine/device.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "engine/bytes.h"
#include "engine/cache_file.h"
#include "engine/cache_folder.h"
#include "engine/drivers/matrix_units.h"
#include "engine/drivers/selection.h"
#include "engine/drivers/traits.h"
#include "engine/drivers/vulkan_result.h"
#include "engine/environment.h"
#include "engine/handles.h"
#include "engine/host_device.h"
#include "engine/kernel_family.h"
#include "xrds/error.h"

namespace xrds {
namespace {

void chooseQueue(Gpu::Handles& gpu) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(gpu.physicalDevice, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(gpu.physicalDevice, &count, families.data());
  // A family with graphics is the main engine of a GPU; compute-only ones are meant for work beside it.
  const auto rank = [](const auto& f) {
    if (!(f.queueFlags & VK_QUEUE_COMPUTE_BIT)) return 0;
    return f.queueFlags & VK_QUEUE_GRAPHICS_BIT ? 2 : 1;
  };
  const auto best = std::max_element(families.begin(), families.end(),
                                     [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  gpu.queueFamily = static_cast<uint32_t>(best - families.begin());
  gpu.timestampValidBits = best->timestampValidBits;
}

std::string hexadecimal(std::span<const uint8_t> bytes) {
  std::string text;
  for (const uint8_t byte : bytes) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

void probe(Gpu::Handles& gpu) {
  VkPhysicalDeviceVulkan11Properties version11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &version11};
  vkGetPhysicalDeviceProperties2(gpu.physicalDevice, &properties);
  vkGetPhysicalDeviceMemoryProperties(gpu.physicalDevice, &gpu.memory);
  gpu.limits = properties.properties.limits;
  gpu.maxAllocationBytes = version11.maxMemoryAllocationSize;
  gpu.traits = traitsOf(gpu.physicalDevice, gpu.description, chosenFamily(gpu.description, gpu.options.kernelFamily),
                        gpu.choosesSubgroups);
  if (gpu.isShared) gpu.traits.bufferAddresses = false;  // the other program may not have enabled them
  gpu.pipelineCacheKey = hexadecimal(properties.properties.pipelineCacheUUID) + "-" +
                         hexadecimal(version11.driverUUID) + "-" + std::to_string(properties.properties.driverVersion);
  if (!gpu.options.cacheFolder.empty())
    gpu.pipelineCacheFile = gpu.options.cacheFolder / ("pipelines-" + gpu.pipelineCacheKey + ".bin");
}

void openDevice(Gpu::Handles& gpu) {
  VkPhysicalDeviceVulkan12Features features12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12};
  features.features.shaderInt64 = features12.shaderSubgroupExtendedTypes = gpu.traits.shaderInt64;
  features12.bufferDeviceAddress = gpu.traits.bufferAddresses;
  MatrixFeatures matrixFeatures;
  matrixFeatures.enable(gpu.traits.matrixUnits, gpu.choosesSubgroups, features12);
  std::vector<const char*> extensions = extensionsOf(gpu.traits.matrixUnits, gpu.choosesSubgroups);
  // A layered implementation (MoltenVK) that lists this extension demands that it is enabled.
  const char* portability = "VK_KHR_portability_subset";
  if (hasDeviceExtension(gpu.physicalDevice, portability)) extensions.push_back(portability);
  createDevice(gpu, features, extensions);
  gpu.vk.vkGetDeviceQueue(gpu.device, gpu.queueFamily, 0, &gpu.queue);
}

void makeCommandObjects(Gpu::Handles& gpu) {
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = gpu.queueFamily;
  checkResult(gpu.vk.vkCreateCommandPool(gpu.device, &pool, nullptr, &gpu.commandPool), "vkCreateCommandPool");
  VkCommandBufferAllocateInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  commands.commandPool = gpu.commandPool;
  commands.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  commands.commandBufferCount = 1;
  checkResult(gpu.vk.vkAllocateCommandBuffers(gpu.device, &commands, &gpu.copyCommands), "vkAllocateCommandBuffers");
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  checkResult(gpu.vk.vkCreateFence(gpu.device, &fence, nullptr, &gpu.copyFence), "vkCreateFence");
}

void loadPipelineCache(Gpu::Handles& gpu) {
  const auto content = readCacheFile(gpu.pipelineCacheFile, gpu.pipelineCacheKey);
  gpu.loadedCacheBytes = content.size();
  VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  info.initialDataSize = content.size();
  info.pInitialData = content.empty() ? nullptr : content.data();
  checkResult(gpu.vk.vkCreatePipelineCache(gpu.device, &info, nullptr, &gpu.pipelineCache), "vkCreatePipelineCache");
}

}  // namespace

void createDevice(Gpu::Handles& gpu, const VkPhysicalDeviceFeatures2& features,
                  std::span<const char* const> extensions) {
  const float priority = 1;
  VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue.queueFamilyIndex = gpu.queueFamily;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &features};
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  checkResult(vkCreateDevice(gpu.physicalDevice, &info, nullptr, &gpu.device), "vkCreateDevice");
  volkLoadDeviceTable(&gpu.vk, gpu.device);
}

std::vector<DeviceDescription> listDevices() {
  const auto held = holdLoader();
  widenCpuVectors();
  std::vector<DeviceDescription> descriptions;
  if (const auto instance = openInstance({}))
    for (const auto& found : findDevices(*instance)) descriptions.push_back(found.description);
  return descriptions;
}

void prepareDrivers(const std::filesystem::path& cacheFolder, bool draws) {
  const auto held = holdLoader();
  std::vector<std::string> notes;
  const auto folder = chooseCacheFolder(cacheFolder, notes);
  // llvmpipe (Mesa 22.3) crashes when it compiles a vertex shader for 512-bit vectors.
  if (!draws) widenCpuVectors();
  separateShaderCache(folder);
}

Gpu::Gpu(DeviceOptions options) : handles_(std::make_unique<Handles>()) {
  const auto held = holdLoader();
  Handles& gpu = *handles_;
  gpu.options = std::move(options);
  gpu.options.cacheFolder = chooseCacheFolder(gpu.options.cacheFolder, gpu.notes);
  widenCpuVectors();
  separateShaderCache(gpu.options.cacheFolder);
  gpu.instance = openInstance(gpu.options);
  const auto found = gpu.instance ? findDevices(*gpu.instance) : std::vector<FoundDevice>();
  std::vector<DeviceDescription> descriptions;
  descriptions.reserve(found.size());
  for (const auto& device : found) descriptions.push_back(device.description);
  const FoundDevice& chosen = found[selectDevice(descriptions, gpu.options.select)];
  gpu.physicalDevice = chosen.physicalDevice;
  gpu.description = chosen.description;
  checkDriver(gpu.description);
  chooseQueue(gpu);
  gpu.choosesSubgroups = subgroupControl(gpu.physicalDevice).areChosen;
  probe(gpu);
  openDevice(gpu);
  makeCommandObjects(gpu);
  loadPipelineCache(gpu);
  loadPace(*this);
}

Gpu::Gpu(DeviceOptions options, const HostDevice& host) : handles_(std::make_unique<Handles>()) {
  const auto held = holdLoader();
  Handles& gpu = *handles_;
  gpu.options = std::move(options);
  gpu.options.cacheFolder = writableCacheFolder(gpu.options.cacheFolder, gpu.notes);
  takeDevice(gpu, host);
  gpu.choosesSubgroups = host.enabled.subgroupSizeControl && subgroupControl(gpu.physicalDevice).areChosen;
  probe(gpu);
  gpu.traits.shaderInt64 = gpu.traits.shaderInt64 && host.enabled.shaderInt64;
  makeCommandObjects(gpu);
  loadPipelineCache(gpu);
  loadPace(*this);
}

Gpu::~Gpu() = default;
Gpu::Gpu(Gpu&&) noexcept = default;
Gpu& Gpu::operator=(Gpu&&) noexcept = default;

const DeviceDescription& Gpu::description() const { return handles_->description; }
const DeviceTraits& Gpu::traits() const { return handles_->traits; }
const std::vector<std::string>& Gpu::notes() const { return handles_->notes; }
bool Gpu::hasAskedFamily() const { return !handles_->options.kernelFamily.empty() || !wantedKernelFamily().empty(); }
bool Gpu::isShared() const { return handles_->isShared; }
const std::filesystem::path& Gpu::cacheFolder() const { return handles_->options.cacheFolder; }
std::string Gpu::driverKey() const {
  const DeviceDescription& device = handles_->description;
  std::string key = handles_->pipelineCacheKey + " " + device.uuid + " " + device.name + " " + device.driver + " " +
                    std::to_string(handles_->traits.subgroupSize);
  // Drivers for CPUs do not tell one from another.
  if (device.kind == DeviceKind::cpu) key += " " + processorName();
  return key;
}
std::span<const uint32_t> Gpu::program(std::string_view name) const {
  return handles_->options.programs ? handles_->options.programs(name) : std::span<const uint32_t>{};
}
Pace Gpu::pace() const { return handles_->pace; }
void Gpu::setPatience(uint32_t seconds) { handles_->patienceSeconds = seconds; }
bool Gpu::hasTimestamps() const { return handles_->timestampValidBits > 0; }
void Gpu::setTraits(const DeviceTraits& traits) { handles_->traits = traits; }

Gpu::Handles::~Handles() {
  if (abandoned) static_cast<void>(instance.release());
  if (!device || abandoned) return;
  staging.reset();
  savePipelineCache(*this);
  savePace(*this);
  for (const auto& [key, made] : pipelines) {
    vk.vkDestroyPipeline(device, made.pipeline, nullptr);
    vk.vkDestroyPipelineLayout(device, made.layout, nullptr);
    vk.vkDestroyDescriptorSetLayout(device, made.setLayout, nullptr);
  }
  vk.vkDestroyPipelineCache(device, pipelineCache, nullptr);
  vk.vkDestroyFence(device, copyFence, nullptr);
  vk.vkDestroyCommandPool(device, commandPool, nullptr);
  if (!isShared) vk.vkDestroyDevice(device, nullptr);
}

void savePipelineCache(Gpu::Handles& gpu) noexcept {
  size_t byteSize = 0;
  if (!gpu.pipelineCache || gpu.pipelineCacheFile.empty()) return;
  if (gpu.vk.vkGetPipelineCacheData(gpu.device, gpu.pipelineCache, &byteSize, nullptr) != VK_SUCCESS) return;
  if (byteSize <= gpu.loadedCacheBytes) return;
  try {
    std::vector<std::byte> content(byteSize);
    if (gpu.vk.vkGetPipelineCacheData(gpu.device, gpu.pipelineCache, &byteSize, content.data()) != VK_SUCCESS) return;
    content.resize(byteSize);
    writeCacheFile(gpu.pipelineCacheFile, gpu.pipelineCacheKey, content);
  } catch (const std::exception&) {  // out of memory: the next process compiles again
  }
}

void loadPace(Gpu& gpu) {
  Gpu::Handles& handles = gpu.handles();
  handles.paceKey = gpu.driverKey();
  if (handles.options.cacheFolder.empty()) return;
  const uint64_t hash = hashOf(std::as_bytes(std::span(handles.paceKey)));
  handles.paceFile = handles.options.cacheFolder / ("pace-" + std::to_string(hash) + ".bin");
  const auto content = readCacheFile(handles.paceFile, handles.paceKey);
  if (content.size() == sizeof(Pace)) std::memcpy(&handles.pace, content.data(), sizeof(Pace));
  handles.savedPace = handles.pace;
}

// Only where it has changed by enough to matter.
void savePace(Gpu::Handles& gpu) noexcept {
  const double ratio = gpu.savedPace.slowest > 0 ? gpu.pace.slowest / gpu.savedPace.slowest : 0;
  if (gpu.paceFile.empty() || gpu.pace.slowest <= 0 || (ratio > 0.7 && ratio < 1.4)) return;
  try {
    writeCacheFile(gpu.paceFile, gpu.paceKey, std::as_bytes(std::span(&gpu.pace, 1)));
  } catch (const std::exception&) {  // out of memory: the next process measures again
  }
}

void runOnce(Gpu::Handles& gpu, const std::function<void(VkCommandBuffer)>& record) {
  requireAnswering(gpu);
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  checkResult(gpu.vk.vkBeginCommandBuffer(gpu.copyCommands, &begin), "vkBeginCommandBuffer");
  fullBarrier(gpu, gpu.copyCommands);
  record(gpu.copyCommands);
  fullBarrier(gpu, gpu.copyCommands);
  checkResult(gpu.vk.vkEndCommandBuffer(gpu.copyCommands), "vkEndCommandBuffer");
  checkResult(gpu.vk.vkResetFences(gpu.device, 1, &gpu.copyFence), "vkResetFences");
  VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &gpu.copyCommands;
  submitToQueue(gpu, submit, gpu.copyFence);
  awaitFence(gpu, gpu.copyFence);
}

// Second by second: a process that is stopped meanwhile, as a job that is suspended, loses one of them, not its
// patience. A wait without memory has not waited: the work goes on, and nothing that it uses may be freed.
void awaitFence(Gpu::Handles& gpu, VkFence fence) {
  constexpr std::chrono::nanoseconds kSecond = std::chrono::seconds(1);
  const auto untold = [](VkResult result) {
    return result == VK_TIMEOUT || result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY;
  };
  VkResult result = VK_TIMEOUT;
  for (uint32_t second = 0; second < gpu.patienceSeconds && untold(result); ++second) {
    if (result != VK_TIMEOUT) std::this_thread::sleep_for(kSecond);
    result = gpu.vk.vkWaitForFences(gpu.device, 1, &fence, VK_TRUE, kSecond.count());
  }
  if (result == VK_ERROR_DEVICE_LOST)
    gpu.lost = true;
  else if (result != VK_SUCCESS)
    gpu.abandoned = true;
  checkResult(untold(result) ? VK_TIMEOUT : result, "vkWaitForFences");
}

void requireAnswering(const Gpu::Handles& gpu) {
  if (gpu.lost) checkResult(VK_ERROR_DEVICE_LOST, "An earlier call");
  if (gpu.abandoned) checkResult(VK_TIMEOUT, "An earlier vkWaitForFences");
}

void submitToQueue(Gpu::Handles& gpu, const VkSubmitInfo& submit, VkFence fence) {
  submitToQueue(gpu, {&submit, 1}, fence);
}

void submitToQueue(Gpu::Handles& gpu, std::span<const VkSubmitInfo> submits, VkFence fence) {
  requireAnswering(gpu);
  const std::lock_guard lock(gpu.queueAccess);
  if (gpu.lockQueue) gpu.lockQueue();
  const VkResult result = gpu.vk.vkQueueSubmit(gpu.queue, static_cast<uint32_t>(submits.size()), submits.data(), fence);
  if (gpu.unlockQueue) gpu.unlockQueue();
  if (result == VK_ERROR_DEVICE_LOST) gpu.lost = true;
  checkResult(result, "vkQueueSubmit");
}

void fullBarrier(const Gpu::Handles& gpu, VkCommandBuffer commands) {
  constexpr VkPipelineStageFlags kStages =
      VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_HOST_BIT;
  VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_HOST_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT |
                          VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_HOST_READ_BIT | VK_ACCESS_HOST_WRITE_BIT;
  gpu.vk.vkCmdPipelineBarrier(commands, kStages, kStages, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

}  // namespace xrds
