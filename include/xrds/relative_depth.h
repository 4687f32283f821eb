#pragma once

#include <algorithm>
#include <iterator>
#include <span>
#include <vector>

namespace xrds {

/// The auxiliary image "depth" of models that take one, of the distances of all pixels of a frame in any unit: three
/// channels a pixel, d / (d + c m) for c = 1/4, 1 and 4 and the (lower) median m. Distances that are 0, negative, not
/// finite or at least 1e8 are background: they become 1 and do not count for the median.
inline std::vector<float> relativeDepth(std::span<const float> distances) {
  const auto isSeen = [](float distance) { return distance > 0 && distance < 1e8F; };
  std::vector<float> seen;
  std::copy_if(distances.begin(), distances.end(), std::back_inserter(seen), isSeen);
  float median = 1;
  if (!seen.empty()) {
    const auto middle = seen.begin() + static_cast<std::ptrdiff_t>((seen.size() - 1) / 2);
    std::nth_element(seen.begin(), middle, seen.end());
    median = *middle;
  }
  std::vector<float> relative;
  relative.reserve(3 * distances.size());
  for (const float distance : distances)
    for (const float scale : {0.25F, 1.F, 4.F})
      relative.push_back(isSeen(distance) ? distance / (distance + scale * median) : 1);
  return relative;
}

}  // namespace xrds
