// A Vulkan layer that makes chosen calls fail, so that the released program meets faults of a device without a line of
// its own for it. Dropped dispatches stand for wrong kernels, hidden features for lesser devices.
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan_core.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "tests/faults/faults.h"

#ifdef _WIN32
#define XRDS_EXPORTED __declspec(dllexport)
#else
#define XRDS_EXPORTED __attribute__((visibility("default")))
#endif

namespace xrds::test {
namespace {

// What comes behind this layer, asked for as the instance is made: later the loader answers with the whole chain.
struct NextOfInstance {
  PFN_vkGetInstanceProcAddr function = nullptr;
  PFN_vkCreateDevice createDevice = nullptr;
  PFN_vkGetPhysicalDeviceFeatures2 features = nullptr;
  PFN_vkEnumerateDeviceExtensionProperties extensions = nullptr;
};

// Never destroyed: the loader may close the layer with an instance and call it again with the next one.
std::mutex& mutex = *new std::mutex;
auto& instances = *new std::map<void*, NextOfInstance>;  // by dispatch key
auto& devices = *new std::map<void*, PFN_vkGetDeviceProcAddr>;
auto& deviceHandles = *new std::map<void*, VkDevice>;

// What the loader puts at the start of every dispatchable handle: equal for a device, its queues and command buffers.
template <class Handle>
void* keyOf(Handle handle) {
  return *reinterpret_cast<void**>(handle);
}

template <class Function, class Handle>
Function nextOfDevice(Handle handle, const char* name) {
  const std::lock_guard lock(mutex);
  void* key = keyOf(handle);
  return reinterpret_cast<Function>(devices.at(key)(deviceHandles.at(key), name));
}

NextOfInstance nextOfInstance(VkPhysicalDevice handle) {
  const std::lock_guard lock(mutex);
  return instances.at(keyOf(handle));
}

template <size_t size>
struct Name {
  char text[size];
  constexpr Name(const char (&given)[size]) { std::copy_n(given, size, text); }
};

template <Name name, class Function>
struct Faulty;

/// A device's function that fails where a rule says so.
template <Name name, class Handle, class... Rest>
struct Faulty<name, VkResult(VKAPI_PTR*)(Handle, Rest...)> {
  static VKAPI_ATTR VkResult VKAPI_CALL call(Handle handle, Rest... rest) {
    if (const auto fault = faultOf(name.text)) return *fault;
    return nextOfDevice<VkResult(VKAPI_PTR*)(Handle, Rest...)>(handle, name.text)(handle, rest...);
  }
};

// The work is done in any case: what dies with a real device must not go on here.
VKAPI_ATTR VkResult VKAPI_CALL waitAndFail(VkDevice device, uint32_t count, const VkFence* fences, VkBool32 all,
                                           uint64_t timeout) {
  const auto wait = nextOfDevice<PFN_vkWaitForFences>(device, "vkWaitForFences");
  const auto fault = faultOf("vkWaitForFences");
  const VkResult result = wait(device, count, fences, all, fault ? UINT64_MAX : timeout);
  return fault.value_or(result);
}

VKAPI_ATTR void VKAPI_CALL dispatchOrDrop(VkCommandBuffer commands, uint32_t x, uint32_t y, uint32_t z) {
  const bool computes = x * y * z > 0;  // one without workgroups only makes a driver compile
  if (!computes || !faultOf("vkCmdDispatch"))
    nextOfDevice<PFN_vkCmdDispatch>(commands, "vkCmdDispatch")(commands, x, y, z);
}

VKAPI_ATTR void VKAPI_CALL featuresOrFewer(VkPhysicalDevice device, VkPhysicalDeviceFeatures2* features) {
  nextOfInstance(device).features(device, features);
  if (faultOf("vkGetPhysicalDeviceFeatures2")) features->features.shaderInt64 = VK_FALSE;
}

constexpr const char* kPortability = "VK_KHR_portability_subset";

// By the rule `portability` a device stands for one of MoltenVK: it lists the extension that must then be enabled.
VKAPI_ATTR VkResult VKAPI_CALL extensionsOrOneMore(VkPhysicalDevice device, const char* layer, uint32_t* count,
                                                   VkExtensionProperties* properties) {
  const auto next = nextOfInstance(device).extensions;
  if (layer || !faultOf("portability")) return next(device, layer, count, properties);
  uint32_t below = 0;
  next(device, nullptr, &below, nullptr);
  std::vector<VkExtensionProperties> all(below);
  next(device, nullptr, &below, all.data());
  std::strcpy(all.emplace_back().extensionName, kPortability);
  if (!properties) {
    *count = static_cast<uint32_t>(all.size());
    return VK_SUCCESS;
  }
  *count = std::min(*count, static_cast<uint32_t>(all.size()));
  std::copy_n(all.begin(), *count, properties);
  return *count < all.size() ? VK_INCOMPLETE : VK_SUCCESS;
}

// The extensions to enable, without that one; nothing where it should be among them and is not.
std::optional<std::vector<const char*>> withoutPortability(const VkDeviceCreateInfo& info) {
  std::vector<const char*> names(info.ppEnabledExtensionNames,
                                 info.ppEnabledExtensionNames + info.enabledExtensionCount);
  const size_t removed = std::erase_if(names, [](const char* name) { return !std::strcmp(name, kPortability); });
  if (faultOf("portability") && removed == 0) return std::nullopt;
  return names;
}

// The link of this layer in the chain that the loader hands down, moved on to the next layer.
template <class CreateInfo>
auto* takeLink(const void* chain, VkStructureType type) {
  auto* info = static_cast<CreateInfo*>(const_cast<void*>(chain));
  while (info && !(info->sType == type && info->function == VK_LAYER_LINK_INFO))
    info = static_cast<CreateInfo*>(const_cast<void*>(info->pNext));
  auto* link = info->u.pLayerInfo;
  info->u.pLayerInfo = link->pNext;
  return link;
}

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                              VkInstance* instance) {
  const auto next = takeLink<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO)
                        ->pfnNextGetInstanceProcAddr;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(next(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = create(info, allocator, instance);
  if (result != VK_SUCCESS) return result;
  const std::lock_guard lock(mutex);
  instances[keyOf(*instance)] = {
      next, reinterpret_cast<PFN_vkCreateDevice>(next(*instance, "vkCreateDevice")),
      reinterpret_cast<PFN_vkGetPhysicalDeviceFeatures2>(next(*instance, "vkGetPhysicalDeviceFeatures2")),
      reinterpret_cast<PFN_vkEnumerateDeviceExtensionProperties>(
          next(*instance, "vkEnumerateDeviceExtensionProperties"))};
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL createDevice(VkPhysicalDevice physicalDevice, const VkDeviceCreateInfo* info,
                                            const VkAllocationCallbacks* allocator, VkDevice* device) {
  if (const auto fault = faultOf("vkCreateDevice")) return *fault;
  const auto* link = takeLink<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  const auto create = nextOfInstance(physicalDevice).createDevice;
  const auto names = withoutPortability(*info);
  if (!names) return VK_ERROR_INITIALIZATION_FAILED;
  VkDeviceCreateInfo passed = *info;
  passed.enabledExtensionCount = static_cast<uint32_t>(names->size());
  passed.ppEnabledExtensionNames = names->data();
  const VkResult result = create(physicalDevice, &passed, allocator, device);
  if (result != VK_SUCCESS) return result;
  const std::lock_guard lock(mutex);
  devices[keyOf(*device)] = link->pfnNextGetDeviceProcAddr;
  deviceHandles[keyOf(*device)] = *device;
  return result;
}

#define XRDS_FAULTY(name) \
  { #name, reinterpret_cast < PFN_vkVoidFunction>(&Faulty <#name, PFN_##name>::call) }

PFN_vkVoidFunction ownFunction(const char* name) {
  static const std::map<std::string, PFN_vkVoidFunction> kOwn = {
      {"vkCreateInstance", reinterpret_cast<PFN_vkVoidFunction>(&createInstance)},
      {"vkCreateDevice", reinterpret_cast<PFN_vkVoidFunction>(&createDevice)},
      {"vkGetPhysicalDeviceFeatures2", reinterpret_cast<PFN_vkVoidFunction>(&featuresOrFewer)},
      {"vkEnumerateDeviceExtensionProperties", reinterpret_cast<PFN_vkVoidFunction>(&extensionsOrOneMore)},
      {"vkWaitForFences", reinterpret_cast<PFN_vkVoidFunction>(&waitAndFail)},
      {"vkCmdDispatch", reinterpret_cast<PFN_vkVoidFunction>(&dispatchOrDrop)},
      XRDS_FAULTY(vkAllocateMemory),
      XRDS_FAULTY(vkBindBufferMemory),
      XRDS_FAULTY(vkMapMemory),
      XRDS_FAULTY(vkCreateBuffer),
      XRDS_FAULTY(vkCreateBufferView),
      XRDS_FAULTY(vkCreateCommandPool),
      XRDS_FAULTY(vkAllocateCommandBuffers),
      XRDS_FAULTY(vkBeginCommandBuffer),
      XRDS_FAULTY(vkEndCommandBuffer),
      XRDS_FAULTY(vkCreateFence),
      XRDS_FAULTY(vkResetFences),
      XRDS_FAULTY(vkQueueSubmit),
      XRDS_FAULTY(vkCreateDescriptorPool),
      XRDS_FAULTY(vkAllocateDescriptorSets),
      XRDS_FAULTY(vkCreateDescriptorSetLayout),
      XRDS_FAULTY(vkCreatePipelineLayout),
      XRDS_FAULTY(vkCreatePipelineCache),
      XRDS_FAULTY(vkCreateShaderModule),
      XRDS_FAULTY(vkCreateComputePipelines)};
  const auto found = kOwn.find(name);
  return found == kOwn.end() ? nullptr : found->second;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL deviceFunction(VkDevice device, const char* name) {
  if (const auto own = ownFunction(name)) return own;
  const std::lock_guard lock(mutex);
  return devices.at(keyOf(device))(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instanceFunction(VkInstance instance, const char* name) {
  if (!std::strcmp(name, "vkGetDeviceProcAddr")) return reinterpret_cast<PFN_vkVoidFunction>(&deviceFunction);
  if (const auto own = ownFunction(name)) return own;
  if (!instance) return nullptr;
  const std::lock_guard lock(mutex);
  return instances.at(keyOf(instance)).function(instance, name);
}

}  // namespace
}  // namespace xrds::test

extern "C" XRDS_EXPORTED VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
  version->loaderLayerInterfaceVersion = 2;
  version->pfnGetInstanceProcAddr = &xrds::test::instanceFunction;
  version->pfnGetDeviceProcAddr = &xrds::test::deviceFunction;
  version->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
