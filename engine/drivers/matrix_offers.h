#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "engine/device_traits.h"
#include "engine/drivers/instance.h"
#include "engine/drivers/vulkan_result.h"

namespace xrds {

/// The sizes and types of matrices that an extension's query gives of a device; none where there is no such query.
template <class Properties>
std::vector<Properties> offersOf(const Instance& instance, VkPhysicalDevice device, const char* query,
                                 VkStructureType type) {
  using Query = VkResult(VKAPI_PTR*)(VkPhysicalDevice, uint32_t*, Properties*);
  const auto ask = reinterpret_cast<Query>(vkGetInstanceProcAddr(instance.instance, query));
  uint32_t count = 0;
  if (!ask) return {};
  checkResult(ask(device, &count, nullptr), query);
  Properties empty{};
  empty.sType = type;
  std::vector<Properties> offers(count, empty);
  checkResult(ask(device, &count, offers.data()), query);
  return offers;
}

/// The largest product among those that a kernel's fragments of 16 x 16 are made of. fits() says of an offer whether it
/// is one of halves with sums of that type.
template <class Properties, class Fits>
std::optional<MatrixSize> largestOf(const std::vector<Properties>& offered, const Fits& fits, auto floats,
                                    auto halves) {
  const auto divides = [](uint32_t side) { return side == 8 || side == 16; };
  std::optional<MatrixSize> best;
  for (const Properties& p : offered)
    if (fits(p, floats) && divides(p.MSize) && divides(p.NSize) && divides(p.KSize) &&
        (!best || p.MSize * p.NSize * p.KSize > best->rows * best->columns * best->depth))
      best = {.rows = p.MSize, .columns = p.NSize, .depth = p.KSize};
  if (best)
    best->halfSums = std::any_of(offered.begin(), offered.end(), [&](const Properties& p) {
      return fits(p, halves) && p.MSize == best->rows && p.NSize == best->columns && p.KSize == best->depth;
    });
  return best;
}

}  // namespace xrds
