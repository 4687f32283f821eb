#pragma once

#include "engine/device.h"
#include "xrds/xrds.h"

namespace xrds {

struct Device::State {
  Gpu gpu;
};

}  // namespace xrds
