#include "viewer/tracer/bvh.h"

#include <algorithm>
#include <numeric>

#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint32_t kBins = 12;

struct TreeNode {
  Bounds box;
  uint32_t begin = 0, end = 0;  // of a leaf, in the order of triangles
  int axis = -1;                // of an inner node: its children are split along it
  uint32_t left = 0, right = 0;
};

struct Builder {
  std::vector<Bounds> boxes;
  std::vector<uint32_t> order;
  std::vector<TreeNode> nodes;

  uint32_t build(uint32_t begin, uint32_t end);
  uint32_t split(uint32_t begin, uint32_t end, const Bounds& centres, int& axis);
};

struct Bin {
  Bounds box;
  uint32_t count = 0;
};

struct Cut {
  float cost = 1e30F;
  int axis = -1;
  uint32_t bin = 0;  // the first of the right side
};

uint32_t binOf(const Bounds& centres, Vec3 centre, int axis) {
  const float extent = std::max(centres.upper[axis] - centres.lower[axis], 1e-30F);
  return std::min(kBins - 1, static_cast<uint32_t>(kBins * ((centre[axis] - centres.lower[axis]) / extent)));
}

void improve(Cut& best, const std::array<Bin, kBins>& bins, int axis) {
  std::array<float, kBins> rightCosts{};
  Bin right;
  for (uint32_t i = kBins; i-- > 1;) {
    right.box.include(bins[i].box);
    right.count += bins[i].count;
    rightCosts[i] = right.count ? right.box.halfArea() * static_cast<float>(right.count) : 0;
  }
  Bin left;
  for (uint32_t i = 1; i < kBins; ++i) {
    left.box.include(bins[i - 1].box);
    left.count += bins[i - 1].count;
    const float cost = rightCosts[i] + (left.count ? left.box.halfArea() * static_cast<float>(left.count) : 0);
    if (left.count && rightCosts[i] >= 0 && cost < best.cost) best = {cost, axis, i};
  }
}

// Reorders the triangles and returns where the right side begins; `axis` is that of the cut.
uint32_t Builder::split(uint32_t begin, uint32_t end, const Bounds& centres, int& axis) {
  Cut best;
  for (int candidate = 0; candidate < 3; ++candidate) {
    if (centres.upper[candidate] <= centres.lower[candidate]) continue;
    std::array<Bin, kBins> bins;
    for (uint32_t i = begin; i < end; ++i) {
      Bin& bin = bins[binOf(centres, boxes[order[i]].centre(), candidate)];
      bin.box.include(boxes[order[i]]);
      ++bin.count;
    }
    improve(best, bins, candidate);
  }
  axis = std::max(best.axis, 0);
  const auto first = order.begin() + begin, last = order.begin() + end;
  const auto middle = std::partition(first, last, [&](uint32_t triangle) {
    return best.axis >= 0 && binOf(centres, boxes[triangle].centre(), best.axis) < best.bin;
  });
  const auto at = static_cast<uint32_t>(middle - order.begin());
  return at == begin || at == end ? (begin + end) / 2 : at;  // all centres in one place
}

uint32_t Builder::build(uint32_t begin, uint32_t end) {
  TreeNode node{.begin = begin, .end = end};
  Bounds centres;
  for (uint32_t i = begin; i < end; ++i) {
    node.box.include(boxes[order[i]]);
    centres.include(boxes[order[i]].centre());
  }
  const auto index = static_cast<uint32_t>(nodes.size());
  nodes.push_back(node);
  if (end - begin <= Bvh::kMaxLeafTriangles / 2) return index;
  int axis = 0;
  const uint32_t middle = split(begin, end, centres, axis);
  const uint32_t left = build(begin, middle), right = build(middle, end);
  nodes[index].axis = axis;
  nodes[index].left = left;
  nodes[index].right = right;
  return index;
}

void emit(const std::vector<TreeNode>& tree, uint32_t index, uint32_t octant, uint32_t origin,
          std::vector<BvhNode>& nodes) {
  const TreeNode& node = tree[index];
  const size_t place = nodes.size();
  nodes.push_back({.lower = node.box.lower, .upper = node.box.upper});
  if (node.axis < 0) {
    nodes[place].leaf = static_cast<float>(node.begin * Bvh::kMaxLeafTriangles + node.end - node.begin - 1);
  } else {
    const bool isReversed = octant >> node.axis & 1;
    emit(tree, isReversed ? node.right : node.left, octant, origin, nodes);
    emit(tree, isReversed ? node.left : node.right, octant, origin, nodes);
  }
  nodes[place].skip = static_cast<float>(nodes.size() - origin);
}

}  // namespace

Bvh buildBvh(std::span<const Triangle> triangles) {
  constexpr size_t kMostTriangles = (size_t{1} << 24) / Bvh::kMaxLeafTriangles;  // whole numbers that a float holds
  if (triangles.empty()) throw Error("The scene has no triangles.");
  if (triangles.size() > kMostTriangles)
    throw Error("The scene has " + std::to_string(triangles.size()) + " triangles, at most " +
                std::to_string(kMostTriangles) + " are possible.");
  Builder builder;
  for (const Triangle& triangle : triangles) {
    Bounds box;
    for (const Vec3& position : triangle.positions) box.include(position);
    builder.boxes.push_back(box);
  }
  builder.order.resize(triangles.size());
  std::iota(builder.order.begin(), builder.order.end(), 0U);
  builder.build(0, static_cast<uint32_t>(triangles.size()));

  Bvh bvh{.bounds = builder.nodes[0].box,
          .triangles = std::move(builder.order),
          .nodeCount = static_cast<uint32_t>(builder.nodes.size())};
  bvh.nodes.reserve(size_t{Bvh::kOctants} * bvh.nodeCount);
  for (uint32_t octant = 0; octant < Bvh::kOctants; ++octant)
    emit(builder.nodes, 0, octant, octant * bvh.nodeCount, bvh.nodes);
  return bvh;
}

}  // namespace xrds
