#pragma once

#include <volk.h>

#include <string>

namespace xrds {

/// "out of device memory (VK_ERROR_OUT_OF_DEVICE_MEMORY)".
std::string resultText(VkResult result);

/// Throws Error naming the call and the result unless it is VK_SUCCESS; of memory OutOfMemory, of a device that is lost
/// or does not answer DeviceLost.
void checkResult(VkResult result, const char* call);

}  // namespace xrds
