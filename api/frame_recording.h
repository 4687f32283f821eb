#pragma once

#include <memory>

#include "api/frame_upscaler.h"
#include "xrds/xrds_vulkan.h"

namespace xrds {

/// FrameRecording of the public API, which documents what the functions do.
class RecordedFrame {
 public:
  /// The upscalers must outlive it; alpha: of the frame's alpha, if it has one.
  RecordedFrame(FrameUpscaler& upscaler, const XrdsVulkanFrame& frame, const FrameUpscaler* alpha);
  ~RecordedFrame();
  RecordedFrame(const RecordedFrame&) = delete;
  RecordedFrame& operator=(const RecordedFrame&) = delete;

  void record(VkCommandBuffer commands) const;
  void submit(std::span<const XrdsTimelinePoint> waits, std::span<const XrdsTimelinePoint> signals);
  bool run(const Upscaler::Progress& progress);
  float exposure() const;
  std::vector<Upscaler::ProfileRow> profile() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace xrds
