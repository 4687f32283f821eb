#include "app/nearest.h"

#include <algorithm>

namespace xrds {
namespace {

// Edit distance in which a swap of two neighbours counts once.
size_t slips(const std::string& a, const std::string& b) {
  std::vector<std::vector<size_t>> cost(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i) cost[i][0] = i;
  for (size_t j = 0; j <= b.size(); ++j) cost[0][j] = j;
  for (size_t i = 1; i <= a.size(); ++i)
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t changed = cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, changed});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  return cost[a.size()][b.size()];
}

}  // namespace

std::string nearest(const std::string& typed, const std::vector<std::string>& names) {
  constexpr size_t kLetters = 3;  // fewer could begin anything
  std::string best;
  size_t fewest = std::max<size_t>(1, typed.size() / 3) + 1;
  for (const std::string& name : names)
    if (const size_t count = slips(typed, name); count < fewest && count < name.size()) {
      fewest = count;
      best = name;
    }
  if (!best.empty() || typed.size() < kLetters) return best;
  const auto longer = std::find_if(names.begin(), names.end(), [&](const auto& n) { return n.starts_with(typed); });
  return longer == names.end() ? "" : *longer;
}

}  // namespace xrds
