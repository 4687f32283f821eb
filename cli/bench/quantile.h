#pragma once

#include <algorithm>
#include <vector>

namespace xrds {

/// That of the values at `share` of them in order, interpolated; there must be some.
inline double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<size_t>(at);
  const double above = values[std::min(below + 1, values.size() - 1)];
  return values[below] + (at - static_cast<double>(below)) * (above - values[below]);
}
inline double median(const std::vector<double>& values) { return quantile(values, 0.5); }

}  // namespace xrds
