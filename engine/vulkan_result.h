#pragma once

#include <volk.h>

#include <string>

namespace xrds {

/// "out of device memory (VK_ERROR_OUT_OF_DEVICE_MEMORY)".
std::string resultText(VkResult result);

/// Throws Error naming the call and the result unless it is VK_SUCCESS.
void checkResult(VkResult result, const char* call);

}  // namespace xrds
