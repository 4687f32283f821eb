#include "tests/vulkan_host.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace xrds::test {
namespace {

template <class Function>
Function instanceFunction(VkInstance instance, const char* name) {
  return reinterpret_cast<Function>(VulkanHost::systemLoader()(instance, name));
}

VKAPI_ATTR VkBool32 VKAPI_CALL hear(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                    const VkDebugUtilsMessengerCallbackDataEXT* message, void*) {
  VulkanHost::messages().emplace_back(message->pMessage);
  return VK_FALSE;
}

void check(VkResult result, const char* what) {
  if (result != VK_SUCCESS) throw std::runtime_error(std::string(what) + " gives " + std::to_string(result));
}

}  // namespace

VulkanHost::VulkanHost() {
  openInstance();
  openDevice();
  takeCalls();
}

VulkanHost::~VulkanHost() {
  vk.vkDeviceWaitIdle(device);
  for (const HostBuffer& each : buffers_) {
    vk.vkDestroyBuffer(device, each.buffer, nullptr);
    vk.vkFreeMemory(device, each.memory, nullptr);
  }
  for (const HostPicture2d& each : images_) {
    vk.vkDestroyImage(device, each.image, nullptr);
    vk.vkFreeMemory(device, each.memory, nullptr);
  }
  for (const VkSemaphore each : semaphores_) vk.vkDestroySemaphore(device, each, nullptr);
  vk.vkDestroyCommandPool(device, pool_, nullptr);
  vk.vkDestroyDevice(device, nullptr);
  if (messenger_)
    instanceFunction<PFN_vkDestroyDebugUtilsMessengerEXT>(instance, "vkDestroyDebugUtilsMessengerEXT")(
        instance, messenger_, nullptr);
  instanceFunction<PFN_vkDestroyInstance>(instance, "vkDestroyInstance")(instance, nullptr);
}

std::vector<std::string>& VulkanHost::messages() {
  static std::vector<std::string> messages;
  return messages;
}

void VulkanHost::openInstance() {
  VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType =
      VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  messenger.pfnUserCallback = hear;
  const VkValidationFeatureEnableEXT enabled[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT synchronization{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, &messenger};
  synchronization.enabledValidationFeatureCount = 1;
  synchronization.pEnabledValidationFeatures = enabled;
  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.apiVersion = VK_API_VERSION_1_2;
  const char *layer = "VK_LAYER_KHRONOS_validation", *extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  const bool validates = !std::getenv("XRDS_TEST_NO_VALIDATION");
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, validates ? &synchronization : nullptr};
  info.pApplicationInfo = &application;
  info.enabledLayerCount = validates ? 1 : 0;
  info.ppEnabledLayerNames = &layer;
  info.enabledExtensionCount = validates ? 1 : 0;
  info.ppEnabledExtensionNames = &extension;
  check(instanceFunction<PFN_vkCreateInstance>(nullptr, "vkCreateInstance")(&info, nullptr, &instance),
        "vkCreateInstance");
  if (!validates) return;
  check(instanceFunction<PFN_vkCreateDebugUtilsMessengerEXT>(instance, "vkCreateDebugUtilsMessengerEXT")(
            instance, &messenger, nullptr, &messenger_),
        "vkCreateDebugUtilsMessengerEXT");
}

bool VulkanHost::shares(VkSemaphoreType kind, VkExternalSemaphoreHandleTypeFlagBits handle) const {
  VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
  type.semaphoreType = kind;
  VkPhysicalDeviceExternalSemaphoreInfo asked{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_EXTERNAL_SEMAPHORE_INFO, &type};
  asked.handleType = handle;
  VkExternalSemaphoreProperties properties{VK_STRUCTURE_TYPE_EXTERNAL_SEMAPHORE_PROPERTIES};
  instanceFunction<PFN_vkGetPhysicalDeviceExternalSemaphoreProperties>(
      instance, "vkGetPhysicalDeviceExternalSemaphoreProperties")(physicalDevice, &asked, &properties);
  constexpr VkExternalSemaphoreFeatureFlags kBoth =
      VK_EXTERNAL_SEMAPHORE_FEATURE_EXPORTABLE_BIT | VK_EXTERNAL_SEMAPHORE_FEATURE_IMPORTABLE_BIT;
  return (properties.externalSemaphoreFeatures & kBoth) == kBoth;
}

// Of those by which another device shares memory and semaphores, what there is.
std::vector<const char*> VulkanHost::sharingExtensions() {
  uint32_t count = 0;
  const auto list =
      instanceFunction<PFN_vkEnumerateDeviceExtensionProperties>(instance, "vkEnumerateDeviceExtensionProperties");
  list(physicalDevice, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  list(physicalDevice, nullptr, &count, extensions.data());
  const auto has = [&](const char* name) {
    return std::any_of(extensions.begin(), extensions.end(),
                       [&](const auto& each) { return std::strcmp(each.extensionName, name) == 0; });
  };
  sharesMemory_ = has(VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME);
  const bool sharesSemaphores = has(VK_KHR_EXTERNAL_SEMAPHORE_FD_EXTENSION_NAME);
  sharesTimelines_ =
      sharesSemaphores && shares(VK_SEMAPHORE_TYPE_TIMELINE, VK_EXTERNAL_SEMAPHORE_HANDLE_TYPE_OPAQUE_FD_BIT);
  sharesSignals_ = sharesSemaphores && shares(VK_SEMAPHORE_TYPE_BINARY, VK_EXTERNAL_SEMAPHORE_HANDLE_TYPE_SYNC_FD_BIT);
  std::vector<const char*> found;
  if (sharesMemory_) found.push_back(VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME);
  if (sharesSemaphores) found.push_back(VK_KHR_EXTERNAL_SEMAPHORE_FD_EXTENSION_NAME);
  return found;
}

void VulkanHost::openDevice() {
  uint32_t count = 1;
  instanceFunction<PFN_vkEnumeratePhysicalDevices>(instance, "vkEnumeratePhysicalDevices")(instance, &count,
                                                                                           &physicalDevice);
  if (count == 0) throw std::runtime_error("There is no Vulkan device.");
  features.structSize = sizeof features;
  if (xrdsGetVulkanFeatures(systemLoader(), instance, physicalDevice, &features) != XRDS_OK)
    throw std::runtime_error(xrdsGetMessage());
  const float priority = 1;
  VkDeviceQueueCreateInfo queues{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queues.queueCount = 1;
  queues.pQueuePriorities = &priority;
  VkPhysicalDeviceVulkan12Features features12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  features12.shaderSubgroupExtendedTypes = static_cast<VkBool32>(features.shaderSubgroupExtendedTypes);
  features12.timelineSemaphore = VK_TRUE;
  VkPhysicalDeviceFeatures2 enabled{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12};
  enabled.features.shaderInt64 = static_cast<VkBool32>(features.shaderInt64);
  // The rest belongs to matrix units, whose structures the host of the tests does not know.
  features.cooperativeMatrixKhr = features.cooperativeMatrixNv = 0;
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &enabled};
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queues;
  const std::vector<const char*> extensions = sharingExtensions();
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  check(instanceFunction<PFN_vkCreateDevice>(instance, "vkCreateDevice")(physicalDevice, &info, nullptr, &device),
        "vkCreateDevice");
  const auto deviceLoader = instanceFunction<PFN_vkGetDeviceProcAddr>(instance, "vkGetDeviceProcAddr");
#define XRDS_LOAD(name) vk.name = reinterpret_cast<PFN_##name>(deviceLoader(device, #name));
  XRDS_DEVICE_FUNCTIONS(XRDS_LOAD)
#undef XRDS_LOAD
  vk.vkGetDeviceQueue(device, queueFamily, 0, &queue);
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  check(vk.vkCreateCommandPool(device, &pool, nullptr, &pool_), "vkCreateCommandPool");
}

XrdsVulkanDevice VulkanHost::vulkan() const {
  return {.structSize = sizeof(XrdsVulkanDevice),
          .queueFamily = queueFamily,
          .loader = loader(),
          .instance = instance,
          .physicalDevice = physicalDevice,
          .device = device,
          .queue = queue,
          .enabled = &features};
}

VkDeviceMemory VulkanHost::allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted, const void* next) {
  VkPhysicalDeviceMemoryProperties properties;
  instanceFunction<PFN_vkGetPhysicalDeviceMemoryProperties>(instance, "vkGetPhysicalDeviceMemoryProperties")(
      physicalDevice, &properties);
  VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, next};
  info.allocationSize = needs.size;
  for (uint32_t type = properties.memoryTypeCount; type-- > 0;)
    if ((needs.memoryTypeBits >> type & 1) && (properties.memoryTypes[type].propertyFlags & wanted) == wanted)
      info.memoryTypeIndex = type;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  check(vk.vkAllocateMemory(device, &info, nullptr, &memory), "vkAllocateMemory");
  return memory;
}

HostBuffer VulkanHost::buffer(uint64_t byteSize, VkBufferUsageFlags usage) {
  return bufferIn(byteSize, usage, nullptr, false);
}

HostBuffer VulkanHost::exported(uint64_t byteSize, int& descriptor) {
  descriptor = -1;
  if (!sharesMemory_) return {};
  VkExportMemoryAllocateInfo exports{VK_STRUCTURE_TYPE_EXPORT_MEMORY_ALLOCATE_INFO};
  exports.handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
  const HostBuffer made = bufferIn(byteSize, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, &exports, true);
  VkMemoryGetFdInfoKHR get{VK_STRUCTURE_TYPE_MEMORY_GET_FD_INFO_KHR};
  get.memory = made.memory;
  get.handleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
  check(vk.vkGetMemoryFdKHR(device, &get, &descriptor), "vkGetMemoryFdKHR");
  return made;
}

HostBuffer VulkanHost::imported(uint64_t byteSize, int descriptor) {
  VkImportMemoryFdInfoKHR imports{VK_STRUCTURE_TYPE_IMPORT_MEMORY_FD_INFO_KHR};
  imports.handleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
  imports.fd = descriptor;
  return bufferIn(byteSize, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, &imports, true);
}

HostBuffer VulkanHost::bufferIn(uint64_t byteSize, VkBufferUsageFlags usage, const void* memoryOf, bool isExternal) {
  HostBuffer made;
  VkExternalMemoryBufferCreateInfo external{VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_BUFFER_CREATE_INFO};
  external.handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, isExternal ? &external : nullptr};
  info.size = byteSize;
  info.usage = usage;
  check(vk.vkCreateBuffer(device, &info, nullptr, &made.buffer), "vkCreateBuffer");
  VkMemoryRequirements needs;
  vk.vkGetBufferMemoryRequirements(device, made.buffer, &needs);
  made.memory = allocate(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT, memoryOf);
  check(vk.vkBindBufferMemory(device, made.buffer, made.memory, 0), "vkBindBufferMemory");
  void* bytes = nullptr;
  check(vk.vkMapMemory(device, made.memory, 0, VK_WHOLE_SIZE, 0, &bytes), "vkMapMemory");
  made.bytes = static_cast<std::byte*>(bytes);
  return buffers_.emplace_back(made);
}

HostPicture2d VulkanHost::image(uint32_t width, uint32_t height, VkFormat format, VkImageUsageFlags usage) {
  HostPicture2d made;
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {width, height, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.usage = usage;
  check(vk.vkCreateImage(device, &info, nullptr, &made.image), "vkCreateImage");
  VkMemoryRequirements needs;
  vk.vkGetImageMemoryRequirements(device, made.image, &needs);
  made.memory = allocate(needs, 0);
  check(vk.vkBindImageMemory(device, made.image, made.memory, 0), "vkBindImageMemory");
  return images_.emplace_back(made);
}

void VulkanHost::transition(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vk.vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0,
                          nullptr, 0, nullptr, 1, &barrier);
}

void VulkanHost::copy(VkCommandBuffer commands, VkBuffer buffer, VkImage image, uint32_t width, uint32_t height,
                      bool toImage) {
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {width, height, 1};
  if (toImage)
    vk.vkCmdCopyBufferToImage(commands, buffer, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
  else
    vk.vkCmdCopyImageToBuffer(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1, &region);
}

VkSemaphore VulkanHost::timeline() { return semaphore(VK_SEMAPHORE_TYPE_TIMELINE); }

VkSemaphore VulkanHost::exportedTimeline(int& descriptor) {
  constexpr auto kHandle = VK_EXTERNAL_SEMAPHORE_HANDLE_TYPE_OPAQUE_FD_BIT;
  const VkSemaphore made = semaphore(VK_SEMAPHORE_TYPE_TIMELINE, kHandle);
  descriptor = exportedFrom(made, kHandle);
  return made;
}

VkSemaphore VulkanHost::importedTimeline(int descriptor) {
  const VkSemaphore made = timeline();
  import(made, VK_EXTERNAL_SEMAPHORE_HANDLE_TYPE_OPAQUE_FD_BIT, 0, descriptor);
  return made;
}

int VulkanHost::exportSignal(XrdsTimelinePoint behind) {
  constexpr auto kHandle = VK_EXTERNAL_SEMAPHORE_HANDLE_TYPE_SYNC_FD_BIT;
  const VkSemaphore made = semaphore(VK_SEMAPHORE_TYPE_BINARY, kHandle);
  submitBetween(behind, {made, 0});
  return exportedFrom(made, kHandle);
}

void VulkanHost::importSignal(int descriptor, XrdsTimelinePoint signal) {
  const VkSemaphore made = semaphore(VK_SEMAPHORE_TYPE_BINARY);
  import(made, VK_EXTERNAL_SEMAPHORE_HANDLE_TYPE_SYNC_FD_BIT, VK_SEMAPHORE_IMPORT_TEMPORARY_BIT, descriptor);
  submitBetween({made, 0}, signal);
}

int VulkanHost::exportedFrom(VkSemaphore from, VkExternalSemaphoreHandleTypeFlagBits handle) {
  int descriptor = -1;
  VkSemaphoreGetFdInfoKHR get{VK_STRUCTURE_TYPE_SEMAPHORE_GET_FD_INFO_KHR};
  get.semaphore = from;
  get.handleType = handle;
  check(vk.vkGetSemaphoreFdKHR(device, &get, &descriptor), "vkGetSemaphoreFdKHR");
  return descriptor;
}

void VulkanHost::import(VkSemaphore to, VkExternalSemaphoreHandleTypeFlagBits handle, VkSemaphoreImportFlags flags,
                        int descriptor) {
  VkImportSemaphoreFdInfoKHR imports{VK_STRUCTURE_TYPE_IMPORT_SEMAPHORE_FD_INFO_KHR};
  imports.semaphore = to;
  imports.flags = flags;
  imports.handleType = handle;
  imports.fd = descriptor;
  check(vk.vkImportSemaphoreFdKHR(device, &imports), "vkImportSemaphoreFdKHR");
}

void VulkanHost::submitBetween(XrdsTimelinePoint wait, XrdsTimelinePoint signal) {
  const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
  VkTimelineSemaphoreSubmitInfo values{VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO};
  VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO, &values};
  values.waitSemaphoreValueCount = info.waitSemaphoreCount = wait.semaphore ? 1 : 0;
  values.pWaitSemaphoreValues = &wait.value;
  info.pWaitSemaphores = &wait.semaphore;
  info.pWaitDstStageMask = &stage;
  values.signalSemaphoreValueCount = info.signalSemaphoreCount = 1;
  values.pSignalSemaphoreValues = &signal.value;
  info.pSignalSemaphores = &signal.semaphore;
  check(vk.vkQueueSubmit(queue, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit");
}

void VulkanHost::await(XrdsTimelinePoint point) {
  VkSemaphoreWaitInfo wait{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};
  wait.semaphoreCount = 1;
  wait.pSemaphores = &point.semaphore;
  wait.pValues = &point.value;
  check(vk.vkWaitSemaphores(device, &wait, 60'000'000'000), "vkWaitSemaphores");
}

VkSemaphore VulkanHost::semaphore(VkSemaphoreType kind, VkExternalSemaphoreHandleTypeFlags handles) {
  VkExportSemaphoreCreateInfo exports{VK_STRUCTURE_TYPE_EXPORT_SEMAPHORE_CREATE_INFO};
  exports.handleTypes = handles;
  VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO, handles ? &exports : nullptr};
  type.semaphoreType = kind;
  const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type};
  VkSemaphore semaphore = VK_NULL_HANDLE;
  check(vk.vkCreateSemaphore(device, &info, nullptr, &semaphore), "vkCreateSemaphore");
  return semaphores_.emplace_back(semaphore);
}

VkCommandBuffer VulkanHost::begin() {
  VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  info.commandPool = pool_;
  info.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  check(vk.vkAllocateCommandBuffers(device, &info, &commands), "vkAllocateCommandBuffers");
  VkCommandBufferBeginInfo begun{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begun.flags = VK_COMMAND_BUFFER_USAGE_SIMULTANEOUS_USE_BIT;
  check(vk.vkBeginCommandBuffer(commands, &begun), "vkBeginCommandBuffer");
  return commands;
}

void VulkanHost::end(VkCommandBuffer commands) { check(vk.vkEndCommandBuffer(commands), "vkEndCommandBuffer"); }

void VulkanHost::submit(VkCommandBuffer commands) {
  VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands;
  check(vk.vkQueueSubmit(queue, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit");
}

void VulkanHost::await() { check(vk.vkDeviceWaitIdle(device), "vkDeviceWaitIdle"); }

}  // namespace xrds::test
