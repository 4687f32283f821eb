#pragma once

#include <vulkan/vulkan_core.h>

#include <optional>
#include <string_view>

namespace xrds::test {

/// The result with which this call of a Vulkan function shall fail, by $XRDS_FAULTS: rules NAME:FIRST:COUNT:RESULT,
/// separated by commas. The FIRST-th call (from 1) of the function and the COUNT - 1 behind it fail, with COUNT 0 all;
/// calls are counted over the whole process. The name `any` counts the calls of every function that has a result.
/// The name `portability` makes devices such as MoltenVK's, whatever its RESULT. What fails first is appended to the
/// file $XRDS_FAULTS_LOG. Nothing if the call shall go through. Safe from several threads.
std::optional<VkResult> faultOf(std::string_view function);

}  // namespace xrds::test
