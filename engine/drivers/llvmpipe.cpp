#include "engine/drivers/llvmpipe.h"

#include <cstdio>
#include <string>
#include <utility>

namespace xrds {

LlvmpipeTraits llvmpipeTraits(std::string_view driver) {
  std::pair<int, int> mesa;
  if (std::sscanf(std::string(driver).c_str(), "llvmpipe Mesa %d.%d", &mesa.first, &mesa.second) != 2) return {};
  LlvmpipeTraits traits{.comparesSharedLoads = true};
  if (mesa >= std::pair(23, 2)) traits.laneCode = mesa < std::pair(25, 1) ? LaneCode::broadcasts : LaneCode::scalars;
  return traits;
}

bool llvmpipeMultiplies(std::string_view driver, uint32_t subgroupSize) {
  return !driver.starts_with("llvmpipe") || subgroupSize == 8;
}

}  // namespace xrds
