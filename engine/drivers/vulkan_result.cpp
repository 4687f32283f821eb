#include "engine/drivers/vulkan_result.h"

#include "xrds/error.h"

namespace xrds {

std::string resultText(VkResult result) {
  switch (result) {
    case VK_NOT_READY:
      return "not ready (VK_NOT_READY)";
    case VK_TIMEOUT:
      return "the device did not finish within minutes (VK_TIMEOUT)";
    case VK_INCOMPLETE:
      return "the answer is incomplete (VK_INCOMPLETE)";
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "out of host memory (VK_ERROR_OUT_OF_HOST_MEMORY)";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "out of device memory (VK_ERROR_OUT_OF_DEVICE_MEMORY)";
    case VK_ERROR_OUT_OF_POOL_MEMORY:
      return "out of descriptor memory (VK_ERROR_OUT_OF_POOL_MEMORY)";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "the driver could not start (VK_ERROR_INITIALIZATION_FAILED)";
    case VK_ERROR_DEVICE_LOST:
      return "the device was lost: its driver was reset, or a submission ran too long (VK_ERROR_DEVICE_LOST)";
    case VK_ERROR_MEMORY_MAP_FAILED:
      return "memory could not be mapped (VK_ERROR_MEMORY_MAP_FAILED)";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "a layer is not installed (VK_ERROR_LAYER_NOT_PRESENT)";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "an extension is missing (VK_ERROR_EXTENSION_NOT_PRESENT)";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "a feature is missing (VK_ERROR_FEATURE_NOT_PRESENT)";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "no usable Vulkan driver (VK_ERROR_INCOMPATIBLE_DRIVER)";
    case VK_ERROR_TOO_MANY_OBJECTS:
      return "too many objects (VK_ERROR_TOO_MANY_OBJECTS)";
    default:
      return "VkResult " + std::to_string(static_cast<int>(result));
  }
}

void checkResult(VkResult result, const char* call) {
  if (result == VK_SUCCESS) return;
  const std::string text = std::string(call) + " failed: " + resultText(result);
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_POOL_MEMORY:
      throw OutOfMemory(text + "; use smaller tiles or images, or close other programs.");
    case VK_ERROR_DEVICE_LOST:
    case VK_TIMEOUT:
      throw DeviceLost(text + "; try again, update its driver, or choose another device.");
    default:
      throw Error(text + "; update the device's driver, or choose another device.");
  }
}

}  // namespace xrds
