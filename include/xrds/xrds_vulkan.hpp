#pragma once

#include <utility>

#include "xrds/xrds.hpp"
#include "xrds/xrds_vulkan.h"

namespace xrds {

/// xrdsOpenVulkanDevice(): shares a program's own device, which must outlive what is returned. Of the options `select`
/// must be empty, and validation is that of the program's instance. Throws Error.
inline Device openVulkanDevice(const XrdsVulkanDevice& vulkan, const Device::Options& options = {}) {
  return {options, [&](const XrdsDeviceOptions* asked, XrdsDevice** device) {
            return xrdsOpenVulkanDevice(&vulkan, asked, device);
          }};
}

/// A frame of an upscaler whose pixels are in Vulkan buffers and images of the program (XrdsRecording). Used by one
/// thread at a time, but for record().
class FrameRecording {
 public:
  /// xrdsCreateRecording(). The upscaler must be of a device of openVulkanDevice(). Throws Error.
  FrameRecording(Upscaler& upscaler, const XrdsVulkanFrame& frame) {
    XrdsRecording* made = nullptr;
    const XrdsResult result = xrdsCreateRecording(upscaler.handle(), &frame, &made);
    handle_.reset(made);
    upscaler.finish(result);
  }

  /// xrdsRecord()
  void record(VkCommandBuffer commands) const { call::check(xrdsRecord(handle(), commands)); }
  /// xrdsSubmit(). Throws DeviceLost or OutOfMemory.
  void submit(std::span<const XrdsTimelinePoint> waits, std::span<const XrdsTimelinePoint> signals) {
    call::check(xrdsSubmit(handle(), waits.data(), static_cast<uint32_t>(waits.size()), signals.data(),
                           static_cast<uint32_t>(signals.size())));
  }
  /// xrdsRun(): submits the frame piece by piece and waits for it; returns false if `progress` cancelled it. Pieces
  /// are those of Upscaler::Options. Throws DeviceLost or OutOfMemory.
  bool run(const Upscaler::Progress& progress = {}) {
    call::Heard heard(progress);
    const XrdsResult result =
        xrdsRun(handle(), progress ? decltype(heard)::template hear<double> : nullptr, heard.user());
    heard.finish(result == XRDS_CANCELLED ? XRDS_OK : result);
    return result == XRDS_OK;
  }

  float exposure() const { return xrdsGetRecordingExposure(handle()); }  // of the last run()
  std::vector<Upscaler::ProfileRow> profile() const {  // of the last run(); empty without Upscaler::Options::profile
    std::vector<Upscaler::ProfileRow> rows;
    const auto add = [&](const XrdsProfileRow* row) { rows.push_back(call::profileRow(*row)); };
    call::Heard heard(add);
    heard.finish(
        xrdsGetRecordingProfile(handle(), decltype(heard)::template listen<const XrdsProfileRow*>, heard.user()));
    return rows;
  }

  /// For the functions of the C API; valid as long as the recording lives.
  XrdsRecording* handle() const { return handle_.get(); }

 private:
  struct Destroy {
    void operator()(XrdsRecording* recording) const { xrdsDestroyRecording(recording); }
  };
  std::unique_ptr<XrdsRecording, Destroy> handle_;
};

}  // namespace xrds
