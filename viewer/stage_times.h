#pragma once

#include <string>
#include <vector>

#include "xrds/xrds.h"

namespace xrds {

/// A part of the way from file to picture.
struct StageTime {
  std::string name;
  double milliseconds = 0;
};

/// The dispatches of a run summed by the part of the network that they belong to, in the order of the network; empty
/// if the device has no timestamps.
std::vector<StageTime> stageTimes(const std::vector<Upscaler::ProfileRow>& rows);

}  // namespace xrds
