#include "engine/drivers/instance.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <sstream>
#include <tuple>

#include "engine/drivers/llvmpipe.h"
#include "engine/drivers/matrix_units.h"
#include "engine/drivers/traits.h"
#include "engine/drivers/vulkan_result.h"
#include "engine/kernel_family.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

constexpr const char* kNoLoader =
    "No Vulkan loader was found; install the graphics driver of your GPU or the package with the Vulkan loader "
    "(libvulkan1, vulkan-loader).";

VKAPI_ATTR VkBool32 VKAPI_CALL receiveMessage(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                              const VkDebugUtilsMessengerCallbackDataEXT* message, void* user) {
  const auto& instance = *static_cast<const Instance*>(user);
  if (instance.onMessage) instance.onMessage(message->pMessage);
  return VK_FALSE;
}

bool hasLayer(const char* name) {
  uint32_t count = 0;
  checkResult(vkEnumerateInstanceLayerProperties(&count, nullptr), "vkEnumerateInstanceLayerProperties");
  std::vector<VkLayerProperties> layers(count);
  checkResult(vkEnumerateInstanceLayerProperties(&count, layers.data()), "vkEnumerateInstanceLayerProperties");
  return std::any_of(layers.begin(), layers.end(), [&](const auto& l) { return !std::strcmp(l.layerName, name); });
}

bool hasInstanceExtension(const char* name) {
  uint32_t count = 0;
  checkResult(vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr),
              "vkEnumerateInstanceExtensionProperties");
  std::vector<VkExtensionProperties> extensions(count);
  checkResult(vkEnumerateInstanceExtensionProperties(nullptr, &count, extensions.data()),
              "vkEnumerateInstanceExtensionProperties");
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& e) { return !std::strcmp(e.extensionName, name); });
}

VkDebugUtilsMessengerCreateInfoEXT messengerInfo(Instance* instance) {
  VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  info.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  // Not the general type: that is the loader speaking of the machine's drivers, not of what we do.
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  info.pfnUserCallback = receiveMessage;
  info.pUserData = instance;
  return info;
}

DeviceKind kindOf(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return DeviceKind::discrete;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return DeviceKind::integrated;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return DeviceKind::virtualGpu;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return DeviceKind::cpu;
    default:
      return DeviceKind::other;
  }
}

bool hasComputeQueue(VkPhysicalDevice device) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  return std::any_of(families.begin(), families.end(),
                     [](const auto& f) { return f.queueFlags & VK_QUEUE_COMPUTE_BIT; });
}

std::string versionText(uint32_t version) {
  std::ostringstream text;
  text << VK_API_VERSION_MAJOR(version) << '.' << VK_API_VERSION_MINOR(version) << '.' << VK_API_VERSION_PATCH(version);
  return text.str();
}

}  // namespace

DeviceDescription describe(const Instance& instance, VkPhysicalDevice device) {
  VkPhysicalDeviceVulkan12Properties version12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES};
  VkPhysicalDeviceVulkan11Properties version11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES, &version12};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &version11};
  vkGetPhysicalDeviceProperties2(device, &properties);
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(device, &memory);

  DeviceDescription description;
  description.name = properties.properties.deviceName;
  description.kind = kindOf(properties.properties.deviceType);
  for (const uint8_t byte : version11.deviceUUID) {
    description.uuid += "0123456789abcdef"[byte >> 4];
    description.uuid += "0123456789abcdef"[byte & 15];
  }
  description.driver = std::string(version12.driverName).append(" ").append(version12.driverInfo);
  if (llvmpipeMultiplies(description.driver, version11.subgroupSize) &&
      holdsFragments(subgroupControl(device), registersOf(properties.properties.vendorID, description.kind)))
    std::tie(description.matrixUnits, description.matrixSize) = findMatrixUnits(instance, device);
  description.kernelFamily = suitableFamily(description);
  description.apiVersion = versionText(properties.properties.apiVersion);
  for (uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
      description.memoryBytes = std::max<uint64_t>(description.memoryBytes, memory.memoryHeaps[i].size);
  return description;
}

Instance::~Instance() {
  if (messenger) destroyMessenger(instance, messenger, nullptr);
  if (instance && destroy) destroy(instance, nullptr);
}

std::unique_lock<std::recursive_mutex> holdLoader() {
  static std::recursive_mutex access;
  return std::unique_lock(access);
}

std::unique_ptr<Instance> takeInstance(VkInstance instance, PFN_vkGetInstanceProcAddr loader) {
  if (loader)
    volkInitializeCustom(loader);
  else if (volkInitialize() != VK_SUCCESS)
    throw Error(kNoLoader);
  volkLoadInstanceOnly(instance);
  auto taken = std::make_unique<Instance>();
  taken->instance = instance;
  return taken;
}

std::unique_ptr<Instance> openInstance(const DeviceOptions& options) {
  const bool validation = options.validation;
  const auto held = holdLoader();
  if (volkInitialize() != VK_SUCCESS) throw Error(kNoLoader);
  if (volkGetInstanceVersion() < VK_API_VERSION_1_2)
    throw Error("The Vulkan loader is older than version 1.2; update it or the graphics driver.");
  if (validation && !hasLayer(kValidationLayer))
    throw Error(std::string("Validation was asked for, but the layer ") + kValidationLayer +
                " is not installed; install the Vulkan validation layers or open the device without validation.");

  auto result = std::make_unique<Instance>();
  result->onMessage = options.onMessage;

  std::vector<const char*> extensions;
  VkInstanceCreateFlags flags = 0;
  if (hasInstanceExtension(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME)) {
    extensions.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
    flags |= VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR;
  }
  if (validation) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);

  const VkValidationFeatureEnableEXT enabled[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkDebugUtilsMessengerCreateInfoEXT messenger = messengerInfo(result.get());
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, &messenger};
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = enabled;

  const void* wanted = &features;
#ifdef VK_EXT_layer_settings  // newer layers do not look at what shaders access unless told
  const VkBool32 on = VK_TRUE;
  const auto enable = [&on](const char* name) {
    return VkLayerSettingEXT{kValidationLayer, name, VK_LAYER_SETTING_TYPE_BOOL32_EXT, 1, &on};
  };
  const VkLayerSettingEXT values[] = {enable("validate_sync"), enable("syncval_shader_accesses_heuristic")};
  const VkLayerSettingsCreateInfoEXT settings{VK_STRUCTURE_TYPE_LAYER_SETTINGS_CREATE_INFO_EXT, &features, 2, values};
  wanted = &settings;
#endif

  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "xrds";
  application.apiVersion = VK_API_VERSION_1_2;
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, validation ? wanted : nullptr};
  info.flags = flags;
  info.pApplicationInfo = &application;
  info.enabledLayerCount = validation ? 1 : 0;
  info.ppEnabledLayerNames = &kValidationLayer;
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  const VkResult created = vkCreateInstance(&info, nullptr, &result->instance);
  if (created == VK_ERROR_INCOMPATIBLE_DRIVER) return nullptr;
  checkResult(created, "vkCreateInstance");
  volkLoadInstanceOnly(result->instance);
  result->destroy = vkDestroyInstance;

  if (validation) {
    result->destroyMessenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(result->instance, "vkDestroyDebugUtilsMessengerEXT"));
    const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(result->instance, "vkCreateDebugUtilsMessengerEXT"));
    checkResult(create(result->instance, &messenger, nullptr, &result->messenger), "vkCreateDebugUtilsMessengerEXT");
  }
  return result;
}

std::vector<VkPhysicalDevice> physicalDevices(VkInstance instance) {
  uint32_t count = 0;
  checkResult(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> handles(count);
  checkResult(vkEnumeratePhysicalDevices(instance, &count, handles.data()), "vkEnumeratePhysicalDevices");
  return handles;
}

std::vector<FoundDevice> findDevices(const Instance& instance) {
  std::vector<FoundDevice> found;
  for (const VkPhysicalDevice handle : physicalDevices(instance.instance)) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(handle, &properties);
    if (properties.apiVersion < VK_API_VERSION_1_2 || !hasComputeQueue(handle)) continue;
    found.push_back({handle, describe(instance, handle)});
    found.back().description.index = static_cast<uint32_t>(found.size() - 1);
  }
  return found;
}

bool hasDeviceExtension(VkPhysicalDevice device, const char* name) {
  uint32_t count = 0;
  checkResult(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr),
              "vkEnumerateDeviceExtensionProperties");
  std::vector<VkExtensionProperties> extensions(count);
  checkResult(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data()),
              "vkEnumerateDeviceExtensionProperties");
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& e) { return !std::strcmp(e.extensionName, name); });
}

}  // namespace xrds
