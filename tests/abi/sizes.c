/* Prints the size of every structure of the C API and the place of every field: what programs were built with. */
#include <stddef.h>
#include <stdio.h>

#include "xrds/xrds_vulkan.h"

#define SIZE(type) printf(#type " %zu\n", sizeof(type))
#define FIELD(type, field) printf(#type "." #field " %zu\n", offsetof(type, field))

int main(void) {
  SIZE(XrdsDeviceDescription);
  FIELD(XrdsDeviceDescription, name);
  FIELD(XrdsDeviceDescription, kind);
  FIELD(XrdsDeviceDescription, uuid);
  FIELD(XrdsDeviceDescription, driver);
  FIELD(XrdsDeviceDescription, apiVersion);
  FIELD(XrdsDeviceDescription, kernelFamily);
  FIELD(XrdsDeviceDescription, memoryBytes);
  SIZE(XrdsDeviceOptions);
  FIELD(XrdsDeviceOptions, select);
  FIELD(XrdsDeviceOptions, cacheFolder);
  FIELD(XrdsDeviceOptions, kernelFamily);
  FIELD(XrdsDeviceOptions, preparation);
  FIELD(XrdsDeviceOptions, preparationUser);
  SIZE(XrdsImage);
  FIELD(XrdsImage, channels);
  FIELD(XrdsImage, pixelStride);
  FIELD(XrdsImage, rowStride);
  FIELD(XrdsImage, width);
  FIELD(XrdsImage, height);
  FIELD(XrdsImage, format);
  SIZE(XrdsUpscalerOptions);
  FIELD(XrdsUpscalerOptions, fp16);
  FIELD(XrdsUpscalerOptions, exposure);
  FIELD(XrdsUpscalerOptions, ensemble);
  FIELD(XrdsUpscalerOptions, memoryBytes);
  FIELD(XrdsUpscalerOptions, skipBound);
  FIELD(XrdsUpscalerOptions, keepUnchanged);
  FIELD(XrdsUpscalerOptions, tune);
  SIZE(XrdsLayer);
  FIELD(XrdsLayer, colour);
  FIELD(XrdsLayer, light);
  FIELD(XrdsLayer, output);
  FIELD(XrdsLayer, followsAlbedo);
  SIZE(XrdsLayerColour);
  FIELD(XrdsLayerColour, low);
  FIELD(XrdsLayerColour, full);
  FIELD(XrdsLayerColour, output);
  SIZE(XrdsLayerSet);
  FIELD(XrdsLayerSet, layerCount);
  FIELD(XrdsLayerSet, colourCount);
  FIELD(XrdsLayerSet, layers);
  FIELD(XrdsLayerSet, colours);
  FIELD(XrdsLayerSet, whole);
  SIZE(XrdsLayerReport);
  FIELD(XrdsLayerReport, share);
  FIELD(XrdsLayerReport, raisedColours);
  FIELD(XrdsLayerReport, unshared);
  SIZE(XrdsTemporalFrame);
  FIELD(XrdsTemporalFrame, colour);
  FIELD(XrdsTemporalFrame, fullColour);
  FIELD(XrdsTemporalFrame, albedo);
  FIELD(XrdsTemporalFrame, normal);
  FIELD(XrdsTemporalFrame, depth);
  FIELD(XrdsTemporalFrame, toPrevious);
  FIELD(XrdsTemporalFrame, toNext);
  SIZE(XrdsTimelinePoint);
  FIELD(XrdsTimelinePoint, semaphore);
  FIELD(XrdsTimelinePoint, value);
  SIZE(XrdsVulkanDevice);
  FIELD(XrdsVulkanDevice, queueFamily);
  FIELD(XrdsVulkanDevice, loader);
  FIELD(XrdsVulkanDevice, instance);
  FIELD(XrdsVulkanDevice, physicalDevice);
  FIELD(XrdsVulkanDevice, device);
  FIELD(XrdsVulkanDevice, queue);
  FIELD(XrdsVulkanDevice, enabled);
  FIELD(XrdsVulkanDevice, lockQueue);
  FIELD(XrdsVulkanDevice, unlockQueue);
  FIELD(XrdsVulkanDevice, queueUser);
  SIZE(XrdsVulkanFeatures);
  FIELD(XrdsVulkanFeatures, shaderInt64);
  FIELD(XrdsVulkanFeatures, shaderSubgroupExtendedTypes);
  FIELD(XrdsVulkanFeatures, shaderFloat16);
  FIELD(XrdsVulkanFeatures, vulkanMemoryModel);
  FIELD(XrdsVulkanFeatures, subgroupSizeControl);
  FIELD(XrdsVulkanFeatures, computeFullSubgroups);
  FIELD(XrdsVulkanFeatures, cooperativeMatrixKhr);
  FIELD(XrdsVulkanFeatures, cooperativeMatrixNv);
  FIELD(XrdsVulkanFeatures, extensions);
  FIELD(XrdsVulkanFeatures, extensionCount);
  SIZE(XrdsVulkanFrame);
  FIELD(XrdsVulkanFrame, auxiliaryCount);
  FIELD(XrdsVulkanFrame, colour);
  FIELD(XrdsVulkanFrame, output);
  FIELD(XrdsVulkanFrame, auxiliary);
  FIELD(XrdsVulkanFrame, exposure);
  FIELD(XrdsVulkanFrame, exposureOffset);
  SIZE(XrdsVulkanImage);
  FIELD(XrdsVulkanImage, width);
  FIELD(XrdsVulkanImage, height);
  FIELD(XrdsVulkanImage, format);
  FIELD(XrdsVulkanImage, buffer);
  FIELD(XrdsVulkanImage, offset);
  FIELD(XrdsVulkanImage, rowPitch);
  FIELD(XrdsVulkanImage, channelCount);
  FIELD(XrdsVulkanImage, layout);
  FIELD(XrdsVulkanImage, image);
  printf("XRDS_OK %d\nXRDS_CANCELLED %d\nXRDS_ERROR_ARGUMENT %d\nXRDS_ERROR_FAILED %d\nXRDS_ERROR_OUT_OF_MEMORY %d\n",
         XRDS_OK, XRDS_CANCELLED, XRDS_ERROR_ARGUMENT, XRDS_ERROR_FAILED, XRDS_ERROR_OUT_OF_MEMORY);
  printf("XRDS_ERROR_DEVICE_LOST %d\nXRDS_ERROR_BUSY %d\nXRDS_ERROR_INTERNAL %d\nXRDS_FLOAT %d\nXRDS_HALF %d\n",
         XRDS_ERROR_DEVICE_LOST, XRDS_ERROR_BUSY, XRDS_ERROR_INTERNAL, XRDS_FLOAT, XRDS_HALF);
  printf("XRDS_TUNE_AUTO %d\nXRDS_TUNE_NEVER %d\nXRDS_TUNE_NOW %d\n", XRDS_TUNE_AUTO, XRDS_TUNE_NEVER, XRDS_TUNE_NOW);
  return 0;
}
