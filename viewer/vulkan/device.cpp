#include "viewer/vulkan/device.h"

#include <algorithm>
#include <cstring>

#include "xrds/error.h"

namespace xrds {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
constexpr const char* kPortabilitySubset = "VK_KHR_portability_subset";

VKAPI_ATTR VkBool32 VKAPI_CALL hear(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                    const VkDebugUtilsMessengerCallbackDataEXT* message, void* user) {
  const auto& options = *static_cast<const VulkanOptions*>(user);
  if (options.onMessage) options.onMessage(message->pMessage);
  return VK_FALSE;
}

// A question of Vulkan's that is asked twice, for the number of answers and for them; none where it fails.
template <class T, class Ask>
std::vector<T> listOf(const Ask& ask) {
  uint32_t count = 0;
  ask(&count, nullptr);
  std::vector<T> list(count);
  ask(&count, list.data());
  list.resize(count);
  return list;
}

bool lists(const std::vector<VkExtensionProperties>& extensions, const char* name) {
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& each) { return std::strcmp(each.extensionName, name) == 0; });
}

bool hasInstanceExtension(const char* name) {
  return lists(listOf<VkExtensionProperties>([](uint32_t* count, VkExtensionProperties* list) {
                 return vkEnumerateInstanceExtensionProperties(nullptr, count, list);
               }),
               name);
}

bool hasValidation() {
  const auto layers = listOf<VkLayerProperties>(
      [](uint32_t* count, VkLayerProperties* list) { return vkEnumerateInstanceLayerProperties(count, list); });
  return std::any_of(layers.begin(), layers.end(),
                     [](const auto& each) { return std::strcmp(each.layerName, kValidationLayer) == 0; });
}

// The first family that computes, one that also draws if there is any.
uint32_t bestQueueFamily(VkPhysicalDevice device) {
  const auto families = listOf<VkQueueFamilyProperties>([&](uint32_t* count, VkQueueFamilyProperties* list) {
    vkGetPhysicalDeviceQueueFamilyProperties(device, count, list);
  });
  const auto firstWith = [&](VkQueueFlags flags) {
    return std::find_if(families.begin(), families.end(),
                        [&](const auto& each) { return (each.queueFlags & flags) == flags; });
  };
  auto found = firstWith(VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT);
  if (found == families.end()) found = firstWith(VK_QUEUE_COMPUTE_BIT);
  return static_cast<uint32_t>(found - families.begin());
}

template <class Function>
Function instanceFunction(VkInstance instance, const char* name) {
  return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance, name));
}

/// The features that xrds asks for, chained for vkCreateDevice.
struct EnabledFeatures {
  explicit EnabledFeatures(const XrdsVulkanFeatures& wanted) {
    const auto bit = [](int32_t is) { return static_cast<VkBool32>(is != 0); };
    all.pNext = &version12;
    all.features.shaderInt64 = bit(wanted.shaderInt64);
    version12.shaderSubgroupExtendedTypes = bit(wanted.shaderSubgroupExtendedTypes);
    version12.shaderFloat16 = bit(wanted.shaderFloat16);
    version12.vulkanMemoryModel = bit(wanted.vulkanMemoryModel);
    if (wanted.subgroupSizeControl || wanted.computeFullSubgroups) chain(subgroups);
    subgroups.subgroupSizeControl = bit(wanted.subgroupSizeControl);
    subgroups.computeFullSubgroups = bit(wanted.computeFullSubgroups);
#ifdef VK_KHR_cooperative_matrix
    khr.cooperativeMatrix = bit(wanted.cooperativeMatrixKhr);
    if (wanted.cooperativeMatrixKhr) chain(khr);
#endif
    nv.cooperativeMatrix = bit(wanted.cooperativeMatrixNv);
    if (wanted.cooperativeMatrixNv) chain(nv);
  }
  template <class Features>
  void chain(Features& more) {
    more.pNext = version12.pNext;
    version12.pNext = &more;
  }

  VkPhysicalDeviceFeatures2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  VkPhysicalDeviceVulkan12Features version12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceSubgroupSizeControlFeaturesEXT subgroups{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_FEATURES_EXT};
#ifdef VK_KHR_cooperative_matrix
  VkPhysicalDeviceCooperativeMatrixFeaturesKHR khr{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_COOPERATIVE_MATRIX_FEATURES_KHR};
#endif
  VkPhysicalDeviceCooperativeMatrixFeaturesNV nv{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_COOPERATIVE_MATRIX_FEATURES_NV};
};

void checkXrds(XrdsResult result) {
  if (result != XRDS_OK) throw Error(xrdsGetMessage());
}

}  // namespace

void checkVulkan(VkResult result, const char* call) {
  if (result == VK_SUCCESS) return;
  const std::string text = std::string(call) + " failed with VkResult " + std::to_string(result);
  if (result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY)
    throw OutOfMemory(text + " (out of memory); look at smaller images, or close other programs.");
  if (result == VK_ERROR_DEVICE_LOST)
    throw DeviceLost(text + " (the device was lost); try again, update its driver, or choose another device.");
  throw Error(text + "; update the device's driver, or choose another device.");
}

VulkanDevice::VulkanDevice(VulkanOptions options) : options_(std::move(options)) {
  checkXrds(xrdsPrepareVulkan(nullptr, options_.instanceExtensions.empty() ? 0 : 1));
  try {
    openInstance();
    checkXrds(xrdsSelectVulkanDevice(nullptr, instance, options_.select.c_str(), &physicalDevice));
    openDevice();
    makeCommandObjects();
  } catch (...) {
    release();
    throw;
  }
}

VulkanDevice::~VulkanDevice() { release(); }

void VulkanDevice::release() {
  if (device) {
    vkDeviceWaitIdle(device);
    vkDestroyFence(device, finished_, nullptr);
    vkDestroyCommandPool(device, pool_, nullptr);
    vkDestroyDevice(device, nullptr);
  }
  if (messenger_)
    instanceFunction<PFN_vkDestroyDebugUtilsMessengerEXT>(instance, "vkDestroyDebugUtilsMessengerEXT")(
        instance, messenger_, nullptr);
  if (instance) vkDestroyInstance(instance, nullptr);
}

void VulkanDevice::openInstance() {
  if (options_.validation && !hasValidation())
    throw Error(std::string("Validation was asked for, but the layer ") + kValidationLayer +
                " is not installed; install the Vulkan validation layers or start without --validation.");
  std::vector<const char*> extensions;
  for (const std::string& name : options_.instanceExtensions) extensions.push_back(name.c_str());
  if (options_.validation) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  const bool listsPortability = hasInstanceExtension(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
  if (listsPortability) extensions.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);

  VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType =
      VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  messenger.pfnUserCallback = hear;
  messenger.pUserData = &options_;
  const VkValidationFeatureEnableEXT synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, &messenger};
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &synchronization;
  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "xrds-view";
  application.apiVersion = VK_API_VERSION_1_2;
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, options_.validation ? &features : nullptr};
  if (listsPortability) info.flags = VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR;
  info.pApplicationInfo = &application;
  info.enabledLayerCount = options_.validation ? 1 : 0;
  info.ppEnabledLayerNames = &kValidationLayer;
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  const VkResult made = vkCreateInstance(&info, nullptr, &instance);
  if (made == VK_ERROR_INCOMPATIBLE_DRIVER)
    throw Error("No Vulkan driver was found; install the graphics driver of your GPU, or mesa-vulkan-drivers.");
  checkVulkan(made, "vkCreateInstance");
  if (options_.validation)
    checkVulkan(instanceFunction<PFN_vkCreateDebugUtilsMessengerEXT>(instance, "vkCreateDebugUtilsMessengerEXT")(
                    instance, &messenger, nullptr, &messenger_),
                "vkCreateDebugUtilsMessengerEXT");
}

void VulkanDevice::openDevice() {
  vkGetPhysicalDeviceProperties(physicalDevice, &properties);
  vkGetPhysicalDeviceMemoryProperties(physicalDevice, &memory);
  queueFamily = bestQueueFamily(physicalDevice);
  features_.structSize = sizeof features_;
  checkXrds(xrdsGetVulkanFeatures(nullptr, instance, physicalDevice, &features_));
#ifndef VK_KHR_cooperative_matrix
  features_.cooperativeMatrixKhr = 0;
#endif
  const EnabledFeatures enabled(features_);
  std::vector<const char*> extensions(features_.extensions, features_.extensions + features_.extensionCount);
  if (!options_.instanceExtensions.empty()) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  const auto offered = listOf<VkExtensionProperties>([&](uint32_t* count, VkExtensionProperties* list) {
    return vkEnumerateDeviceExtensionProperties(physicalDevice, nullptr, count, list);
  });
  if (lists(offered, kPortabilitySubset)) extensions.push_back(kPortabilitySubset);  // what offers it demands it
  const float priority = 1;
  VkDeviceQueueCreateInfo queues{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queues.queueFamilyIndex = queueFamily;
  queues.queueCount = 1;
  queues.pQueuePriorities = &priority;
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &enabled.all};
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queues;
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  checkVulkan(vkCreateDevice(physicalDevice, &info, nullptr, &device), "vkCreateDevice");
  vkGetDeviceQueue(device, queueFamily, 0, &queue);
}

void VulkanDevice::makeCommandObjects() {
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = queueFamily;
  checkVulkan(vkCreateCommandPool(device, &pool, nullptr, &pool_), "vkCreateCommandPool");
  VkCommandBufferAllocateInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  commands.commandPool = pool_;
  commands.commandBufferCount = 1;
  checkVulkan(vkAllocateCommandBuffers(device, &commands, &commands_), "vkAllocateCommandBuffers");
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  checkVulkan(vkCreateFence(device, &fence, nullptr, &finished_), "vkCreateFence");
}

Device VulkanDevice::shared() {
  XrdsVulkanDevice given{.structSize = sizeof given,
                         .queueFamily = queueFamily,
                         .instance = instance,
                         .physicalDevice = physicalDevice,
                         .device = device,
                         .queue = queue,
                         .enabled = &features_,
                         .queueUser = this};
  given.lockQueue = [](void* user) { static_cast<VulkanDevice*>(user)->queueAccess.lock(); };
  given.unlockQueue = [](void* user) { static_cast<VulkanDevice*>(user)->queueAccess.unlock(); };
  return openVulkanDevice(given);
}

void VulkanDevice::submit(const VkSubmitInfo& info, VkFence fence) {
  const std::lock_guard lock(queueAccess);
  checkVulkan(vkQueueSubmit(queue, 1, &info, fence), "vkQueueSubmit");
}

void VulkanDevice::runOnce(const std::function<void(VkCommandBuffer)>& record) {
  const std::lock_guard lock(onceAccess_);
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  checkVulkan(vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer");
  const auto orderAll = [&](VkPipelineStageFlags after) {
    VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, after, 0, 1, &barrier, 0, nullptr, 0, nullptr);
  };
  orderAll(VK_PIPELINE_STAGE_ALL_COMMANDS_BIT);
  record(commands_);
  orderAll(VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT);
  checkVulkan(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
  VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands_;
  submit(info, finished_);
  checkVulkan(vkWaitForFences(device, 1, &finished_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
  checkVulkan(vkResetFences(device, 1, &finished_), "vkResetFences");
}

uint32_t VulkanDevice::memoryType(uint32_t allowed, VkMemoryPropertyFlags wanted) const {
  for (uint32_t type = 0; type < memory.memoryTypeCount; ++type)
    if ((allowed >> type & 1) && (memory.memoryTypes[type].propertyFlags & wanted) == wanted) return type;
  return memory.memoryTypeCount;
}

}  // namespace xrds
