#include "cli/device_json.h"

#include <nlohmann/json.hpp>

namespace xrds {

nlohmann::ordered_json jsonOf(const Device::Description& device) {
  return {{"name", device.name},
          {"kind", device.kind},
          {"uuid", device.uuid},
          {"driver", device.driver},
          {"apiVersion", device.apiVersion},
          {"memoryBytes", device.memoryBytes}};
}

}  // namespace xrds
