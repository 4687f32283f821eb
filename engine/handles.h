#pragma once

#include <atomic>
#include <map>
#include <mutex>

#include "engine/buffer.h"
#include "engine/device.h"
#include "engine/pace.h"
#include "engine/pipelines/pipeline.h"

namespace xrds {

// llvmpipe takes bits 8 to 15 of a texel buffer's size for a mip level, in bytes (Mesa 22.3) or in texels (26.2), and
// compiles a program anew when they turn from zero to something else or change, 26.2 also beyond 65536 texels: with
// every other frame size. So on CPU devices all that are bound have kVariantTexels and a multiple of kVariantStep
// texels, of which the last lie in the bytes that every buffer has to spare.
inline constexpr uint64_t kVariantStep = 65536, kVariantTexels = kVariantStep + 256, kSpareBytes = 16 * kVariantTexels;

/// The Vulkan objects of an open device. Members are null until they are made, so that a constructor that throws
/// half-way is cleaned up here.
struct Gpu::Handles {
  Handles() = default;
  ~Handles();
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;

  DeviceOptions options;
  DeviceDescription description;
  DeviceTraits traits;
  std::vector<std::string> notes;

  std::unique_ptr<Instance> instance;
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
  VkPhysicalDeviceLimits limits{};
  VkPhysicalDeviceMemoryProperties memory{};
  uint64_t maxAllocationBytes = 0;
  uint32_t queueFamily = 0;
  uint32_t timestampValidBits = 0;
  bool choosesSubgroups = false;  // a pipeline does, among several sizes

  VkDevice device = VK_NULL_HANDLE;
  VolkDeviceTable vk{};
  VkQueue queue = VK_NULL_HANDLE;
  std::mutex queueAccess;                        // held while submitting or presenting
  bool isShared = false;                         // instance, device and queue are another program's
  std::function<void()> lockQueue, unlockQueue;  // of that program; may be empty
  VkCommandPool commandPool = VK_NULL_HANDLE;
  VkCommandBuffer copyCommands = VK_NULL_HANDLE;
  VkFence copyFence = VK_NULL_HANDLE;
  std::unique_ptr<Buffer::Handles> staging;  // made at the first copy that needs it

  VkPipelineCache pipelineCache = VK_NULL_HANDLE;
  std::filesystem::path pipelineCacheFile;  // empty: nothing can be written
  std::string pipelineCacheKey;
  size_t loadedCacheBytes = 0;
  VkPipelineCreateFlags pipelineFlags = 0;  // of all that are made
  std::map<PipelineKey, Pipeline> pipelines;

  Pace pace, savedPace;
  std::filesystem::path paceFile;  // empty: nothing can be written
  std::string paceKey;
  // Long enough for a submission that compiles on a busy machine, far longer than a driver's watchdog.
  uint32_t patienceSeconds = kUsualPatienceSeconds;
  // It does not answer: what it may still use is never destroyed, and it gets nothing new.
  std::atomic<bool> abandoned = false;
  // It said that it is lost, and gets nothing new: what it does then may be anything.
  std::atomic<bool> lost = false;
};

struct Buffer::Handles {
  explicit Handles(Gpu::Handles& owner) : gpu(owner) {}
  ~Handles();
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;

  Gpu::Handles& gpu;
  uint64_t byteSize = 0;  // of the allocation, more than was asked for
  uint64_t askedByteSize = 0;
  bool isHosts = false;  // of another program
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  std::byte* mapped = nullptr;  // null if the host cannot see the memory
  uint64_t address = 0;         // for kernels, with DeviceTraits::bufferAddresses
};

/// Makes a device of the physical one, with one queue of its family.
void createDevice(Gpu::Handles& gpu, const VkPhysicalDeviceFeatures2& features,
                  std::span<const char* const> extensions);

/// Makes a program's device the one of these handles. Throws InvalidArgument if what was given does not belong
/// together.
void takeDevice(Gpu::Handles& gpu, const HostDevice& host);

/// Throws DeviceLost if the device once did not answer, so that what it was given may be running still, or was lost.
void requireAnswering(const Gpu::Handles& gpu);

/// Gives commands to the device's queue, which another thread may be using as well. Throws as requireAnswering() does.
void submitToQueue(Gpu::Handles& gpu, const VkSubmitInfo& submit, VkFence fence);
void submitToQueue(Gpu::Handles& gpu, std::span<const VkSubmitInfo> submits, VkFence fence);

/// Records commands, submits them and waits for their end.
void runOnce(Gpu::Handles& gpu, const std::function<void(VkCommandBuffer)>& record);

/// Waits for the submission that signals the fence. Throws DeviceLost if the device is lost, or abandons it if it does
/// not answer for minutes.
void awaitFence(Gpu::Handles& gpu, VkFence fence);

/// Orders everything recorded or done by the host before against everything after.
void fullBarrier(const Gpu::Handles& gpu, VkCommandBuffer commands);

/// The pace that an earlier process measured, and keeping this one's for the next.
void loadPace(Gpu& gpu);
void savePace(Gpu::Handles& gpu) noexcept;

}  // namespace xrds
