#pragma once

#include "xrds/xrds.hpp"
#include "xrds/xrds_vulkan.h"

namespace xrds {

/// xrdsOpenVulkanDevice(): shares a program's own device, which must outlive what is returned. Of the options `select`
/// must be empty, and validation is that of the program's instance. Throws Error.
XRDS_API Device openVulkanDevice(const XrdsVulkanDevice& vulkan, const Device::Options& options = {});

/// A frame of an upscaler whose pixels are in Vulkan buffers and images of the program (XrdsRecording). Used by one
/// thread at a time, but for record().
class XRDS_API FrameRecording {
 public:
  /// xrdsCreateRecording(). The upscaler, which must be of a device of openVulkanDevice(), outlives it. Throws Error.
  FrameRecording(Upscaler& upscaler, const XrdsVulkanFrame& frame);
  ~FrameRecording();
  FrameRecording(FrameRecording&&) noexcept;
  FrameRecording& operator=(FrameRecording&&) noexcept;

  /// xrdsRecord()
  void record(VkCommandBuffer commands) const;
  /// xrdsSubmit(). Throws DeviceLost or OutOfMemory.
  void submit(std::span<const XrdsTimelinePoint> waits, std::span<const XrdsTimelinePoint> signals);
  /// xrdsRun(): submits the frame piece by piece and waits for it; returns false if `progress` cancelled it. Pieces
  /// are those of Upscaler::Options. Throws DeviceLost or OutOfMemory.
  bool run(const Upscaler::Progress& progress = {});

  float exposure() const;                             // of the last run()
  std::vector<Upscaler::ProfileRow> profile() const;  // of the last run(); empty without Upscaler::Options::profile

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace xrds
