#include "xrds/relative_depth.h"

#include <algorithm>

namespace xrds {
namespace {

constexpr float kScales[] = {0.25F, 1.0F, 4.0F};
constexpr float kBackground = 1e8F;

bool isSeen(float distance) { return distance > 0 && distance < kBackground; }

float medianOfSeen(std::span<const float> distances) {
  std::vector<float> seen;
  std::copy_if(distances.begin(), distances.end(), std::back_inserter(seen), isSeen);
  if (seen.empty()) return 1;
  const auto middle = seen.begin() + static_cast<ptrdiff_t>((seen.size() - 1) / 2);
  std::nth_element(seen.begin(), middle, seen.end());
  return *middle;
}

}  // namespace

std::vector<float> relativeDepth(std::span<const float> distances) {
  const float median = medianOfSeen(distances);
  std::vector<float> relative;
  relative.reserve(3 * distances.size());
  for (const float distance : distances)
    for (const float scale : kScales) relative.push_back(isSeen(distance) ? distance / (distance + scale * median) : 1);
  return relative;
}

}  // namespace xrds
