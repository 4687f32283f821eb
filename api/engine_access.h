#pragma once

#include "api/state.h"
#include "frames/host_frame.h"
#include "xrds/xrds_vulkan.hpp"

namespace xrds {

/// What the classes of the API keep to themselves, for their neighbours in this room.
struct EngineAccess {
  static Gpu& gpu(Device& device) { return device.state_->gpu; }
  static Gpu& gpu(const Upscaler& upscaler);
  static Device open(Gpu gpu);
  static const Upscaler::Options& options(const Upscaler& upscaler);
  static const NetworkConfig& config(const Upscaler& upscaler);
  static FrameShape shape(const Upscaler& upscaler);

  /// What a frame is made of. Throws InvalidArgument where that depends on its pixels, or it takes several passes.
  static std::vector<FramePart> parts(const Upscaler& upscaler);
};

std::vector<Upscaler::ProfileRow> profileRows(std::span<const DispatchTime> times);

}  // namespace xrds
