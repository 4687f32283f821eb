#pragma once

#include "engine/device.h"
#include "network/network_model.h"
#include "xrds/tuning.h"

namespace xrds {

/// Tuning::run, ::known and ::summary of an open device.
Tuning::Report tuneFor(Gpu& gpu, const NetworkModel& network, uint32_t width, uint32_t height,
                       const Tuning::Options& options);
std::optional<Tuning::Report> tuningFor(const Gpu& gpu, const NetworkModel& network, uint32_t width, uint32_t height,
                                        bool fp16);
std::vector<std::string> tuningSummary(const Gpu& gpu);

}  // namespace xrds
