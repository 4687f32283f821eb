#include "graph/promotion.h"

#include <map>
#include <utility>

#include "shaders/common/moments.h"

namespace xrds {

std::vector<Promotion> findPromotions(const Graph& graph) {
  Moments moments;
  for (size_t n = 0; n < graph.nodes.size(); ++n) {
    moments.beginOperator(n);
    std::visit([&](const auto& op) { propagate(op, moments); }, graph.nodes[n].op);
  }
  moments.checkRanges();
  std::map<std::pair<std::string, bool>, std::string> found;  // by name: the bands of a layer share one
  for (const auto& [value, reason] : moments.values()) found.try_emplace({graph.values[value].name, false}, reason);
  for (const auto& [node, reason] : moments.weights()) found.try_emplace({graph.nodes[node].name, true}, reason);
  std::vector<Promotion> promotions;
  promotions.reserve(found.size());
  for (auto& [key, reason] : found) promotions.push_back({key.first, key.second, reason});
  return promotions;
}

}  // namespace xrds
