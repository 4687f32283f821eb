#include "frames/tile_choice.h"

#include <algorithm>
#include <set>

#include "network/architecture.h"
#include "network/halo.h"
#include "xrds/error.h"

namespace xrds {
namespace {

/// A grid and its largest crop.
struct Candidate {
  Cut cut;
  FrameShape crop;
  uint64_t work = 0;  // pixels of all crops
  uint64_t cropPixels() const { return uint64_t{crop.width} * crop.height; }
};

/// The largest side and the sum of the sides of the crops along one axis.
struct Sides {
  uint32_t count = 0, largest = 0, sum = 0;
};

// The numbers of tiles along an axis, `wanted` alone or if that is 0 all that make crops of different sizes.
std::vector<Sides> sidesOf(uint32_t wanted, const std::function<std::vector<Tile>(uint32_t)>& cut,
                           uint32_t Rectangle::*side) {
  std::vector<Sides> all;
  std::set<uint32_t> seen;
  for (uint32_t count = wanted ? wanted : 1; count <= (wanted ? wanted : kMostTiles); ++count) {
    Sides sides{count};
    for (const Tile& tile : cut(count)) {
      sides.largest = std::max(sides.largest, tile.crop.*side);
      sides.sum += tile.crop.*side;
    }
    if (seen.insert(sides.largest).second) all.push_back(sides);
  }
  return all;
}

// All grids, those of the least work first.
std::vector<Candidate> candidatesOf(FrameShape frame, uint32_t window, const Cut& wanted) {
  Cut cut = wanted;
  const auto ofColumns = [&](uint32_t count) {
    return cutFrame({1, frame.width}, window, {count, 1, wanted.halo, wanted.wrap});
  };
  const auto ofRows = [&](uint32_t count) { return cutFrame({frame.height, 1}, window, {1, count, wanted.halo}); };
  std::vector<Candidate> candidates;
  for (const Sides& x : sidesOf(wanted.columns, ofColumns, &Rectangle::width))
    for (const Sides& y : sidesOf(wanted.rows, ofRows, &Rectangle::height)) {
      cut.columns = x.count;
      cut.rows = y.count;
      candidates.push_back({cut, {y.largest, x.largest}, uint64_t{x.sum} * y.sum});
    }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.work != b.work ? a.work < b.work : a.cropPixels() > b.cropPixels();
  });
  return candidates;
}

constexpr uint64_t kNoGraph = ~uint64_t{0};  // what a crop needs that is larger than graphs may be

/// What a session of a crop needs, and which share of its pixels would fit the limits: all if that is 1 or more.
struct Needs {
  uint64_t arenaByteSize = 0, largestTexels = 0;  // of one tensor
  double share = 0;
};

/// Asks for the needs of the crops of a model.
class TilePlanner {
 public:
  TilePlanner(const NetworkModel& model, Precision precision, const MemoryLimits& limits)
      : model_(model), precision_(precision), traits_(limits.traits), kernels_(limits.kernels), layers_(limits.layers) {
    const uint32_t window = model.config().window;
    weightByteSize = memoryNeeds(graphOf({window, window}), traits_).weights;
    const uint64_t share = limits.byteSize / limits.sharers;
    room_ = std::min(share - std::min(share, weightByteSize), traits_.maxAllocationBytes);
  }

  Needs needs(FrameShape crop) const {
    const uint32_t side = std::max(crop.width, crop.height), most = kMaxSide / model_.config().scale;
    if (side > most) return {.arenaByteSize = kNoGraph, .share = static_cast<double>(most) / side};
    const Graph graph = graphOf(crop);
    Needs needs{xrds::arenaByteSize(graph)};
    needs.share = static_cast<double>(room_) / static_cast<double>(needs.arenaByteSize);
    for (const Value& value : graph.values) needs.largestTexels = std::max(needs.largestTexels, value.texelCount());
    needs.share = std::min(
        needs.share, static_cast<double>(traits_.maxTexelBufferElements) / static_cast<double>(needs.largestTexels));
    return needs;
  }
  bool fitsMemory(const Needs& needs) const { return needs.arenaByteSize <= room_; }

  uint64_t weightByteSize = 0;

 private:
  Graph graphOf(FrameShape crop) const {
    return buildGraph(
        model_.config(), crop, model_.lookup(),
        fastOn(traits_, {.precision = precision_, .autoExposure = false, .kernels = kernels_, .layers = layers_}));
  }

  const NetworkModel& model_;
  Precision precision_;
  DeviceTraits traits_;
  KernelTable kernels_;
  uint32_t layers_ = 0;
  uint64_t room_ = 0;
};

[[noreturn]] void throwTooSmall(const TilePlanner& planner, const Needs& least, const MemoryLimits& limits,
                                FrameShape smallest, const std::string& orBounded) {
  if (least.arenaByteSize == kNoGraph)
    throw InvalidArgument(
        "The smallest tiles of the frame are " + std::to_string(smallest.width) + " x " +
        std::to_string(smallest.height) + " pixels of the colour, but no side of a tile's output may exceed " +
        std::to_string(kMaxSide) + ": ask for more columns or rows of tiles, or for 0, which is as many as it takes.");
  if (planner.fitsMemory(least))
    throw Error("The smallest tiles of the frame hold a tensor of " + std::to_string(least.largestTexels) +
                " texels, but the device binds at most " + std::to_string(limits.traits.maxTexelBufferElements) +
                ": take " + orBounded + "a smaller model or another device.");
  throw TooLittleMemory(
      "The smallest tiles of the frame need " +
      std::to_string((limits.sharers * (least.arenaByteSize + planner.weightByteSize) + 999'999) / 1'000'000) +
      " MB of device memory, but " + std::to_string(limits.byteSize / 1'000'000) +
      " MB are allowed: allow more, or take fp16, " + orBounded + "or a smaller model.");
}

}  // namespace

TileChoice chooseTiles(const NetworkModel& model, FrameShape frame, Precision precision, const Cut& wanted,
                       const MemoryLimits& limits) {
  const TilePlanner planner(model, precision, limits);
  // Memory grows with the pixels of the crop: of those that are likely not to fit only a few are planned.
  double likelyPixels = 1e30;
  Needs least{kNoGraph};
  const auto candidates = candidatesOf(frame, model.config().window, wanted);
  const auto smallest = std::min_element(candidates.begin(), candidates.end(),
                                         [](const auto& a, const auto& b) { return a.cropPixels() < b.cropPixels(); });
  for (auto candidate = candidates.begin(); candidate != candidates.end(); ++candidate) {
    const auto pixels = static_cast<double>(candidate->cropPixels());
    if (pixels > likelyPixels && candidate != smallest) continue;
    const Needs needs = planner.needs(candidate->crop);
    if (needs.share >= 1)
      return {candidate->cut, candidate->crop, needs.arenaByteSize, planner.weightByteSize,
              static_cast<double>(candidate->work) / (static_cast<double>(frame.width) * frame.height)};
    if (needs.arenaByteSize < least.arenaByteSize) least = needs;
    likelyPixels = std::min(0.98, 1.1 * needs.share) * pixels;
  }
  // Programs that denoise take exact tiles alone.
  const bool mayBeBounded = wanted.halo > boundedHalo(model.config()) && &architectureOf(model.config()) != &kOidn;
  throwTooSmall(planner, least, limits, smallest->crop, mayBeBounded ? "bounded tiles, " : "");
}

}  // namespace xrds
