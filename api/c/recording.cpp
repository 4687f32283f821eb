// Frames of an upscaler in command buffers and on a queue of the caller's.
#include "api/c/handles.h"
#include "api/c/report.h"
#include "api/c/result.h"
#include "api/c/sized.h"
#include "api/frame_recording.h"

using namespace xrds::c;

struct XrdsRecording {
  XrdsRecording(std::shared_ptr<XrdsUpscaler> of, const XrdsVulkanFrame& given) : upscaler(std::move(of)) {
    const XrdsVulkanFrame asked = taken(given, xrdsVulkanFrameDefault());
    const std::lock_guard lock(upscaler->device->access);
    frame.emplace(*upscaler->upscaler, asked, asked.alpha ? &upscaler->alphaUpscaler() : nullptr);
  }
  ~XrdsRecording() {
    const std::lock_guard lock(upscaler->device->access);
    frame.reset();
  }

  const std::shared_ptr<XrdsUpscaler> upscaler;
  std::optional<xrds::RecordedFrame> frame;
};

namespace {

using Recordings = Handles<XrdsRecording>;

}  // namespace

XrdsVulkanImage xrdsBufferImage(VkBuffer buffer, XrdsFormat format, uint32_t channelCount, uint32_t width,
                                uint32_t height) {
  return {.structSize = sizeof(XrdsVulkanImage),
          .width = width,
          .height = height,
          .format = format,
          .buffer = buffer,
          .channelCount = channelCount};
}

XrdsVulkanImage xrdsWholeImage(VkImage image, XrdsFormat format, uint32_t width, uint32_t height) {
  return {.structSize = sizeof(XrdsVulkanImage),
          .width = width,
          .height = height,
          .format = format,
          .layout = VK_IMAGE_LAYOUT_GENERAL,
          .image = image};
}

XrdsVulkanFrame xrdsVulkanFrameDefault() { return {.structSize = sizeof(XrdsVulkanFrame)}; }

XrdsResult xrdsCreateRecording(XrdsUpscaler* upscaler, const XrdsVulkanFrame* frame, XrdsRecording** recording) {
  return guarded([&] {
    XrdsRecording*& out = required(recording, "recording");
    const XrdsVulkanFrame& given = required(frame, "frame");
    const auto of = Upscalers::open().opened(upscaler, "upscaler");
    out = Recordings::open().add(std::make_shared<XrdsRecording>(of, given));
    return XRDS_OK;
  });
}

void xrdsDestroyRecording(XrdsRecording* recording) {
  guarded([&] {
    Recordings::open().remove(recording);
    return XRDS_OK;
  });
}

XrdsResult xrdsRecord(XrdsRecording* recording, VkCommandBuffer commandBuffer) {
  return guarded([&] {
    const auto found = Recordings::open().opened(recording, "recording");
    found->frame->record(commandBuffer);
    return XRDS_OK;
  });
}

XrdsResult xrdsSubmit(XrdsRecording* recording, const XrdsTimelinePoint* waits, uint32_t waitCount,
                      const XrdsTimelinePoint* signals, uint32_t signalCount) {
  return guarded([&] {
    const auto found = Recordings::open().opened(recording, "recording");
    if (waitCount > 0) required(waits, "waits");
    if (signalCount > 0) required(signals, "signals");
    found->frame->submit({waits, waitCount}, {signals, signalCount});
    return XRDS_OK;
  });
}

XrdsResult xrdsRun(XrdsRecording* recording, XrdsProgress progress, void* user) {
  return guarded([&] {
    const auto found = Recordings::open().opened(recording, "recording");
    const std::unique_lock use(found->upscaler->use, std::try_to_lock);
    if (!use) return failed(XRDS_ERROR_BUSY, "The upscaler is in use on another thread: create one for each thread.");
    xrds::Upscaler::Progress hear;
    if (progress) hear = [&](double share) { return progress(user, share) != 0; };
    const std::lock_guard lock(found->upscaler->device->access);
    return found->frame->run(hear) ? XRDS_OK : failed(XRDS_CANCELLED, "The frame was cancelled.");
  });
}

float xrdsGetRecordingExposure(const XrdsRecording* recording) {
  float exposure = 0;
  guarded([&] {
    const auto found = Recordings::open().find(recording);
    if (!found) return XRDS_OK;
    const std::lock_guard lock(found->upscaler->device->access);
    exposure = found->frame->exposure();
    return XRDS_OK;
  });
  return exposure;
}

XrdsResult xrdsGetRecordingProfile(XrdsRecording* recording, XrdsHearProfile hear, void* user) {
  return guarded([&] {
    const auto found = Recordings::open().opened(recording, "recording");
    required(hear, "hear");
    const std::lock_guard lock(found->upscaler->device->access);
    tellProfile(found->frame->profile(), hear, user);
    return XRDS_OK;
  });
}
