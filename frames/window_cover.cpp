#include "frames/window_cover.h"

#include <algorithm>
#include <limits>

#include "engine/check.h"

namespace xrds {
namespace {

constexpr uint32_t kMaxCells = 20;    // of a row or column: more are searched too slowly
constexpr double kWorthwhile = 0.95;  // of the whole frame's cost

/// Half-open ranges of windows, or of cells of windows.
struct Block {
  uint32_t top = 0, bottom = 0, left = 0, right = 0;
  bool empty() const { return top >= bottom || left >= right; }
};

/// The smallest block with all marks of `within`.
Block bounds(const WindowMask& mask, const Block& within) {
  Block box{within.bottom, within.top, within.right, within.left};
  for (uint32_t row = within.top; row < within.bottom; ++row)
    for (uint32_t column = within.left; column < within.right; ++column)
      if (mask.at(row, column)) {
        box.top = std::min(box.top, row);
        box.bottom = row + 1;
        box.left = std::min(box.left, column);
        box.right = std::max(box.right, column + 1);
      }
  return box;
}

double costOf(const Rectangle& crop) { return kTilePixels + static_cast<double>(crop.width) * crop.height; }

/// A part of a frame and how blocks of its windows become tiles.
struct Part {
  FrameShape frame;
  Rectangle inner;
  uint32_t windowSize, halo;

  Tile tile(const Block& block) const {
    const auto range = [&](uint32_t first, uint32_t end, uint32_t from, uint32_t size) {
      return std::pair(from + first * windowSize, from + std::min(end * windowSize, size));
    };
    const auto [left, right] = range(block.left, block.right, static_cast<uint32_t>(inner.x), inner.width);
    const auto [top, bottom] = range(block.top, block.bottom, inner.y, inner.height);
    const uint32_t cropLeft = left - std::min(left, halo), cropTop = top - std::min(top, halo);
    return {{static_cast<int32_t>(cropLeft), cropTop, std::min(right + halo, frame.width) - cropLeft,
             std::min(bottom + halo, frame.height) - cropTop},
            {static_cast<int32_t>(left), top, right - left, bottom - top}};
  }
  double cost(const Block& block) const { return costOf(tile(block).crop); }
};

// The marks of the windows in that rectangle, which begins at a window's corner.
WindowMask marksIn(const WindowMask& mask, const Rectangle& inner, uint32_t windowSize) {
  WindowMask part({inner.height, inner.width}, windowSize, false);
  for (uint32_t row = 0; row < part.rows; ++row)
    std::copy_n(
        &mask.marks[size_t{row + inner.y / windowSize} * mask.columns + static_cast<uint32_t>(inner.x) / windowSize],
        part.columns, &part.at(row, 0));
  return part;
}

/// Finds the cheapest sequence of cuts for every block of cells once.
class CutSearch {
 public:
  CutSearch(const WindowMask& needed, const Part& part)
      : needed_(needed),
        part_(part),
        cellRows_(ceilDivide(needed.rows, kMaxCells)),
        cellColumns_(ceilDivide(needed.columns, kMaxCells)),
        rows_(ceilDivide(needed.rows, cellRows_)),
        columns_(ceilDivide(needed.columns, cellColumns_)),
        sums_(size_t{rows_ + 1} * (columns_ + 1)),
        best_(size_t{rows_ + 1} * (rows_ + 1) * (columns_ + 1) * (columns_ + 1)) {
    const auto sum = [&](uint32_t r, uint32_t c) -> uint32_t& { return sums_[size_t{r} * (columns_ + 1) + c]; };
    for (uint32_t r = 0; r < rows_; ++r)
      for (uint32_t c = 0; c < columns_; ++c) {
        const bool marked = !bounds(needed_, windowsOf({r, r + 1, c, c + 1})).empty();
        sum(r + 1, c + 1) = marked + sum(r, c + 1) + sum(r + 1, c) - sum(r, c);
      }
  }

  std::vector<Tile> tiles() {
    const Block all{0, rows_, 0, columns_};
    if (search(all) > 0) collect(all);
    return std::move(tiles_);
  }

 private:
  struct Best {
    double cost = -1;     // not yet known
    uint32_t cut = 0;     // 0: none, the block is one tile
    bool across = false;  // the cut is horizontal
  };

  uint32_t marked(const Block& b) const {
    const auto sum = [&](uint32_t r, uint32_t c) { return sums_[size_t{r} * (columns_ + 1) + c]; };
    return sum(b.bottom, b.right) - sum(b.top, b.right) - sum(b.bottom, b.left) + sum(b.top, b.left);
  }
  Block windowsOf(const Block& cells) const {
    return {cells.top * cellRows_, std::min(cells.bottom * cellRows_, needed_.rows), cells.left * cellColumns_,
            std::min(cells.right * cellColumns_, needed_.columns)};
  }
  Block shrunk(Block b) const {
    while (marked({b.top, b.top + 1, b.left, b.right}) == 0) ++b.top;
    while (marked({b.bottom - 1, b.bottom, b.left, b.right}) == 0) --b.bottom;
    while (marked({b.top, b.bottom, b.left, b.left + 1}) == 0) ++b.left;
    while (marked({b.top, b.bottom, b.right - 1, b.right}) == 0) --b.right;
    return b;
  }
  Best& bestOf(const Block& b) {
    return best_[((size_t{b.top} * (rows_ + 1) + b.bottom) * (columns_ + 1) + b.left) * (columns_ + 1) + b.right];
  }
  static std::pair<Block, Block> halves(const Block& b, uint32_t cut, bool across) {
    if (across) return {{b.top, cut, b.left, b.right}, {cut, b.bottom, b.left, b.right}};
    return {{b.top, b.bottom, b.left, cut}, {b.top, b.bottom, cut, b.right}};
  }

  double search(const Block& given) {
    if (marked(given) == 0) return 0;
    const Block b = shrunk(given);
    if (const Best& known = bestOf(b); known.cost >= 0) return known.cost;
    Best best{part_.cost(windowsOf(b))};
    const bool full = marked(b) == (b.bottom - b.top) * (b.right - b.left);
    const auto tryCut = [&](uint32_t cut, bool across) {
      const auto [first, second] = halves(b, cut, across);
      const double cost = search(first) + search(second);
      if (cost < best.cost) best = {cost, cut, across};
    };
    for (uint32_t cut = b.top + 1; !full && cut < b.bottom; ++cut) tryCut(cut, true);
    for (uint32_t cut = b.left + 1; !full && cut < b.right; ++cut) tryCut(cut, false);
    bestOf(b) = best;
    return best.cost;
  }

  void collect(const Block& given) {
    if (marked(given) == 0) return;
    const Block b = shrunk(given);
    const Best best = bestOf(b);
    if (best.cut == 0) {
      tiles_.push_back(part_.tile(bounds(needed_, windowsOf(b))));
      return;
    }
    const auto [first, second] = halves(b, best.cut, best.across);
    collect(first);
    collect(second);
  }

  const WindowMask& needed_;
  Part part_;
  uint32_t cellRows_, cellColumns_;  // windows in a cell
  uint32_t rows_, columns_;          // of cells
  std::vector<uint32_t> sums_;       // marked cells above and to the left
  std::vector<Best> best_;
  std::vector<Tile> tiles_;
};

}  // namespace

std::vector<Tile> coverWindows(const WindowMask& needed, FrameShape frame, const Tile& whole, uint32_t windowSize,
                               uint32_t halo) {
  XRDS_CHECK_EQ(halo % windowSize, 0u);
  const WindowMask marks = marksIn(needed, whole.inner, windowSize);
  if (marks.count() == marks.marks.size()) return {whole};
  std::vector<Tile> tiles = CutSearch(marks, {frame, whole.inner, windowSize, halo}).tiles();
  double cost = 0;
  for (const Tile& tile : tiles) cost += costOf(tile.crop);
  if (cost > kWorthwhile * costOf(whole.crop)) return {whole};
  return tiles;
}

WindowMask windowsOutside(std::span<const Tile> tiles, FrameShape frame, uint32_t windowSize) {
  WindowMask outside(frame, windowSize, true);
  for (const Tile& tile : tiles) {
    const Rectangle& inner = tile.inner;
    const uint32_t left = static_cast<uint32_t>(inner.x) / windowSize;
    const uint32_t right = ceilDivide(static_cast<uint32_t>(inner.x) + inner.width, windowSize);
    for (uint32_t row = inner.y / windowSize; row < ceilDivide(inner.y + inner.height, windowSize); ++row)
      std::fill_n(&outside.at(row, left), right - left, uint8_t{0});
  }
  return outside;
}

}  // namespace xrds
