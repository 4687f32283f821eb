#include "graph/planner.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <random>

#include "engine/dispatch.h"

namespace xrds {
namespace {

using Order = std::vector<uint32_t>;

constexpr uint64_t kLongLife = 8;  // steps: more than most bands live

// For each value those that live at the same time; values of no size left out.
std::vector<Order> neighboursOf(std::span<const Lifetime> lifetimes) {
  Order byStart(lifetimes.size());
  std::iota(byStart.begin(), byStart.end(), 0u);
  std::stable_sort(byStart.begin(), byStart.end(),
                   [&](uint32_t a, uint32_t b) { return lifetimes[a].firstUse < lifetimes[b].firstUse; });
  std::vector<Order> neighbours(lifetimes.size());
  Order alive;
  for (const uint32_t value : byStart) {
    if (lifetimes[value].byteSize == 0) continue;
    std::erase_if(alive, [&](uint32_t other) { return lifetimes[other].lastUse < lifetimes[value].firstUse; });
    for (const uint32_t other : alive) {
      neighbours[value].push_back(other);
      neighbours[other].push_back(value);
    }
    alive.push_back(value);
  }
  return neighbours;
}

// Places the values in the given order, each at the lowest offset that is free over its lifetime; nothing if that takes
// more than `most` bytes.
std::optional<MemoryPlan> placeInOrder(std::span<const Lifetime> lifetimes, const std::vector<Order>& neighbours,
                                       const Order& order, uint64_t most) {
  MemoryPlan plan{std::vector<uint64_t>(lifetimes.size()), 0};
  std::vector<bool> placed(lifetimes.size());
  Order taken;  // neighbours that have a place, by offset
  for (const uint32_t value : order) {
    const Lifetime& life = lifetimes[value];
    if (life.byteSize == 0) continue;
    taken.clear();
    for (const uint32_t other : neighbours[value])
      if (placed[other]) taken.push_back(other);
    std::sort(taken.begin(), taken.end(), [&](uint32_t a, uint32_t b) { return plan.offsets[a] < plan.offsets[b]; });
    uint64_t offset = 0;
    for (const uint32_t other : taken) {
      if (plan.offsets[other] >= offset + life.byteSize) break;
      offset = std::max(offset, alignUp(plan.offsets[other] + lifetimes[other].byteSize, life.alignment));
    }
    plan.offsets[value] = offset;
    plan.byteSize = std::max(plan.byteSize, offset + life.byteSize);
    if (plan.byteSize > most) return {};
    placed[value] = true;
  }
  return plan;
}

template <class Less>
Order ordered(size_t count, Less less) {
  Order order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), less);
  return order;
}

}  // namespace

MemoryPlan planMemory(std::span<const Lifetime> lifetimes) {
  const auto size = [&](uint32_t v) { return lifetimes[v].byteSize; };
  const auto span = [&](uint32_t v) { return uint64_t{lifetimes[v].lastUse} - lifetimes[v].firstUse + 1; };
  const auto longFirst = [&](auto less) {
    return ordered(lifetimes.size(), [&](uint32_t a, uint32_t b) {
      const bool longA = span(a) > kLongLife, longB = span(b) > kLongLife;
      if (longA != longB) return longA;
      return longA ? less(a, b) : lifetimes[a].firstUse < lifetimes[b].firstUse;
    });
  };
  const std::vector<Order> starts = {
      ordered(lifetimes.size(), [&](uint32_t a, uint32_t b) { return size(a) > size(b); }),
      ordered(lifetimes.size(), [&](uint32_t a, uint32_t b) { return size(a) * span(a) > size(b) * span(b); }),
      ordered(lifetimes.size(), [&](uint32_t a, uint32_t b) { return lifetimes[a].firstUse < lifetimes[b].firstUse; }),
      // Those that live long first, around them the others as they come: bands follow each other in few places.
      longFirst([&](uint32_t a, uint32_t b) { return size(a) > size(b); }),
      longFirst([&](uint32_t a, uint32_t b) { return span(a) > span(b); }),
      longFirst([&](uint32_t a, uint32_t b) { return lifetimes[a].firstUse < lifetimes[b].firstUse; }),
      longFirst([&](uint32_t a, uint32_t b) { return lifetimes[a].lastUse > lifetimes[b].lastUse; }),
  };
  const std::vector<Order> neighbours = neighboursOf(lifetimes);
  const uint64_t bound = largestLiveSet(lifetimes);
  MemoryPlan best{{}, UINT64_MAX};
  Order bestOrder;
  const auto consider = [&](const Order& order) {
    std::optional<MemoryPlan> plan = placeInOrder(lifetimes, neighbours, order, best.byteSize);
    if (!plan) return;
    best = *std::move(plan);
    bestOrder = order;
  };
  for (const Order& order : starts) consider(order);
  // Local search with a fixed seed: one of the values that live long, or one that lies above the bound, takes another
  // turn, while that does no harm.
  const auto isLong = [&](uint32_t v) { return span(v) > kLongLife; };
  std::minstd_rand random(4);
  for (int trial = 0; trial < 3000 && best.byteSize > bound + bound / 200; ++trial) {
    Order above, early;
    for (uint32_t v = 0; v < lifetimes.size(); ++v)
      if (best.offsets[v] + size(v) > bound) above.push_back(v);
    std::copy_if(bestOrder.begin(), bestOrder.end(), std::back_inserter(early), isLong);
    const Order& candidates = early.empty() || random() % 2 ? above : early;
    const uint32_t moved = candidates[random() % candidates.size()];
    Order order = bestOrder;
    order.erase(std::find(order.begin(), order.end(), moved));
    order.insert(order.begin() + static_cast<ptrdiff_t>(random() % std::max<size_t>(1, early.size())), moved);
    consider(order);
  }
  return best;
}

MemoryPlan planWithoutAliasing(std::span<const Lifetime> lifetimes) {
  MemoryPlan plan;
  for (const Lifetime& life : lifetimes) {
    plan.offsets.push_back(alignUp(plan.byteSize, life.alignment));
    plan.byteSize = plan.offsets.back() + life.byteSize;
  }
  return plan;
}

uint64_t largestLiveSet(std::span<const Lifetime> lifetimes) {
  uint32_t steps = 0;
  for (const Lifetime& life : lifetimes) steps = std::max(steps, life.lastUse + 1);
  std::vector<int64_t> change(steps + 1);
  for (const Lifetime& life : lifetimes) {
    change[life.firstUse] += static_cast<int64_t>(life.byteSize);
    change[life.lastUse + 1] -= static_cast<int64_t>(life.byteSize);
  }
  int64_t live = 0, most = 0;
  for (const int64_t step : change) most = std::max(most, live += step);
  return static_cast<uint64_t>(most);
}

}  // namespace xrds
