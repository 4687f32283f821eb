#pragma once

#include <nlohmann/json_fwd.hpp>

#include "xrds/device.h"

namespace xrds {

/// What every JSON file says of a device.
nlohmann::ordered_json jsonOf(const Device::Description& device);

}  // namespace xrds
