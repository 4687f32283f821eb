/* Frames in Vulkan buffers and images, recorded once. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_C_RECORDING_H
#define XRDS_C_RECORDING_H

#include "xrds/c/vulkan_device.h"
#include "xrds/xrds_report.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct XrdsRecording XrdsRecording;

/* Pixels on the device, rows from the top: in a buffer, interleaved, of which red, green and blue count, or all pixels
 * of an image. Halves are read and written as such. */
typedef struct XrdsVulkanImage {
  uint32_t structSize;
  uint32_t width, height;
  XrdsFormat format;
  /* A buffer with VK_BUFFER_USAGE_STORAGE_BUFFER_BIT. offset: bytes to the top left pixel; rowPitch: bytes from a row
   * to the next, 0: without gaps. Both are multiples of 4. */
  VkBuffer buffer;
  uint64_t offset, rowPitch;
  uint32_t channelCount; /* numbers of a pixel: 3 or 4; the fourth of the output becomes alpha */
  /* Or a 2D image of the format VK_FORMAT_R32G32B32A32_SFLOAT or VK_FORMAT_R16G16B16A16_SFLOAT, of which the first
   * level and layer count, with VK_IMAGE_USAGE_TRANSFER_SRC_BIT, of the output _DST_BIT. layout: when the recording
   * runs, and behind it. */
  VkImageLayout layout;
  VkImage image;
} XrdsVulkanImage;

/* The pixels of a buffer, rows without gaps from its first byte on; and those of an image in VK_IMAGE_LAYOUT_GENERAL.
 */
XRDS_API XrdsVulkanImage xrdsBufferImage(VkBuffer buffer, XrdsFormat format, uint32_t channelCount, uint32_t width,
                                         uint32_t height);
XRDS_API XrdsVulkanImage xrdsWholeImage(VkImage image, XrdsFormat format, uint32_t width, uint32_t height);

/* One frame, as xrdsUpscale() has it, but: of "depth" three channels d / (d + k m), k = 0.25, 1 and 4, of the distances
 * d and their median m, 1 where nothing is seen. Inputs and output must not overlap. */
typedef struct XrdsVulkanFrame {
  uint32_t structSize;
  uint32_t auxiliaryCount;
  XrdsVulkanImage colour, output;
  const XrdsVulkanImage* auxiliary;
  /* A float that is read when the recording runs, at a multiple of 4 bytes, and takes the place of the upscaler's own
   * exposure, which must not be 0 then. Default VK_NULL_HANDLE. */
  VkBuffer exposure;
  uint64_t exposureOffset;
  /* Of the colour's size, or the colour itself: the fourth number of its pixels, or the one of a buffer whose
   * channelCount is 1. Interpolated as by xrdsUpscale() it becomes the output's fourth channel. Default NULL: that
   * is 1. */
  const XrdsVulkanImage* alpha;
} XrdsVulkanFrame;

XRDS_API XrdsVulkanFrame xrdsVulkanFrameDefault(void);

/* Makes an upscaler ready for frames of these buffers and images, which must stay until the recording is destroyed.
 * Slow, once for each of the frames in flight: they share weights and memory. Not for upscalers with an ensemble,
 * skipBound or keepUnchanged. */
XRDS_API XrdsResult xrdsCreateRecording(XrdsUpscaler* upscaler, const XrdsVulkanFrame* frame,
                                        XrdsRecording** recording);

/* Nothing of it may be in flight, or in a command buffer that is yet to be submitted. */
XRDS_API void xrdsDestroyRecording(XrdsRecording* recording);

/* Records the frame into a primary command buffer of the device's queue family, outside of a render pass: one
 * vkCmdExecuteCommands, no allocation, no submission, no wait. The command buffer may be submitted any number of times,
 * to the queue of the device; what was recorded before comes before, what follows after, without further barriers.
 * Recordings of one upscaler run one after the other; xrdsUpscale() of it must wait for them. */
XRDS_API XrdsResult xrdsRecord(XrdsRecording* recording, VkCommandBuffer commandBuffer);

/* A semaphore of type VK_SEMAPHORE_TYPE_TIMELINE and a value of it. */
typedef struct XrdsTimelinePoint {
  VkSemaphore semaphore;
  uint64_t value;
} XrdsTimelinePoint;

/* Submits the frame to the device's queue, in pieces that keep no watchdog waiting, behind the `waits` and signalling
 * the `signals`. Does not wait. */
XRDS_API XrdsResult xrdsSubmit(XrdsRecording* recording, const XrdsTimelinePoint* waits, uint32_t waitCount,
                               const XrdsTimelinePoint* signals, uint32_t signalCount);

/* Submits the frame piece by piece and waits for each: others get the queue in between. progress may be NULL; after
 * XRDS_CANCELLED the output holds anything. */
XRDS_API XrdsResult xrdsRun(XrdsRecording* recording, XrdsProgress progress, void* user);

/* Of the last frame that ran, which must have ended; 0 of a handle that is not open. */
XRDS_API float xrdsGetRecordingExposure(const XrdsRecording* recording);

/* Of the last xrdsRun(), as xrdsGetProfile(). */
XRDS_API XrdsResult xrdsGetRecordingProfile(XrdsRecording* recording, XrdsHearProfile hear, void* user);

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
