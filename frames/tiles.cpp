#include "frames/tiles.h"

#include <algorithm>

#include "engine/check.h"

namespace xrds {
namespace {

/// A tile along one axis.
struct Span {
  int32_t cropBegin = 0, cropEnd = 0, innerBegin = 0, innerEnd = 0;
};

int32_t roundDown(int32_t value, int32_t multiple) { return value / multiple * multiple; }
int32_t roundUp(int32_t value, int32_t multiple) { return roundDown(value + multiple - 1, multiple); }

// Crops of one size, evenly spread over the axis; each two share at least both halos, in the middle of which they meet.
std::vector<Span> cutAxis(int32_t size, int32_t window, int32_t count, int32_t halo) {
  const int32_t windows = roundUp(size, window) / window;
  count = std::clamp(count, 1, std::max(1, windows - 2 * halo / window));
  const int32_t side = roundUp((size + 2 * halo * (count - 1) + count - 1) / count, window);
  std::vector<Span> spans;
  for (int32_t i = 0; i < count; ++i) {
    const int32_t free = std::max(0, roundUp(size, window) - side);
    const int32_t begin = count == 1 ? 0 : roundDown(free / window * i / (count - 1) * window, window);
    Span span{begin, std::min(begin + side, size), 0, size};
    if (i > 0) {
      const int32_t shared = spans.back().cropEnd - begin;
      span.innerBegin = spans.back().innerEnd = begin + roundDown(shared / 2, window);
    }
    spans.push_back(span);
  }
  return spans;
}

// The same on a circle: every crop has its halo on both sides.
std::vector<Span> cutCircle(int32_t size, int32_t window, int32_t count, int32_t halo) {
  const int32_t windows = roundUp(size, window) / window;
  count = std::clamp(count, 1, windows);
  std::vector<Span> spans;
  const int32_t inner = roundUp((windows + count - 1) / count, 1) * window;
  for (int32_t begin = 0; begin < size; begin += inner)
    spans.push_back({begin - halo, begin + inner + halo, begin, std::min(begin + inner, size)});
  return spans;
}

}  // namespace

std::vector<Tile> cutFrame(FrameShape frame, uint32_t window, const Cut& cut) {
  XRDS_CHECK_EQ(cut.halo % window, 0u);
  const auto side = static_cast<int32_t>(window), halo = static_cast<int32_t>(cut.halo);
  const auto width = static_cast<int32_t>(frame.width), height = static_cast<int32_t>(frame.height);
  const auto columns = static_cast<int32_t>(cut.columns), rows = static_cast<int32_t>(cut.rows);
  const auto across = cut.wrap ? cutCircle(width, side, columns, halo) : cutAxis(width, side, columns, halo);
  std::vector<Tile> tiles;
  for (const Span& y : cutAxis(height, side, rows, halo))
    for (const Span& x : across) {
      const auto rectangle = [](int32_t left, int32_t right, int32_t top, int32_t bottom) {
        return Rectangle{left, static_cast<uint32_t>(top), static_cast<uint32_t>(right - left),
                         static_cast<uint32_t>(bottom - top)};
      };
      tiles.push_back({rectangle(x.cropBegin, x.cropEnd, y.cropBegin, y.cropEnd),
                       rectangle(x.innerBegin, x.innerEnd, y.innerBegin, y.innerEnd)});
    }
  return tiles;
}

}  // namespace xrds
