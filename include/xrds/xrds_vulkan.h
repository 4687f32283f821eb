/* xrds in a program that has a Vulkan device of its own: from its buffers and images to its buffers and images, in its
 * command buffers or on its queue, without a copy through the host. Beside xrds.h, whose head tells of results,
 * handles, threads and structures. Needs the Vulkan headers, and links no loader.
 *
 *     xrdsGetVulkanFeatures(loader, instance, physicalDevice, &features);  ... vkCreateDevice with them ...
 *     xrdsOpenVulkanDevice(&mine, NULL, &device);
 *     xrdsCreateUpscaler(device, model, width, height, &options, &upscaler);
 *     xrdsCreateRecording(upscaler, &frame, &recording);
 *     each frame: xrdsRecord(recording, commandBuffer);  ... vkQueueSubmit ...
 *
 * docs/embedding.md is the manual. */
#ifndef XRDS_XRDS_VULKAN_H
#define XRDS_XRDS_VULKAN_H

#include "xrds/c/recording.h"
#include "xrds/c/vulkan_device.h"
#include "xrds/xrds.h"

#endif
