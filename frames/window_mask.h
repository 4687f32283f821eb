#pragma once

#include <algorithm>
#include <vector>

#include "engine/dispatch.h"
#include "network/frame_shape.h"

namespace xrds {

/// A mark on some of a frame's attention windows, row by row; the last window of a row or column may be cut.
struct WindowMask {
  WindowMask(FrameShape frame, uint32_t windowSize, bool marked)
      : rows(ceilDivide(frame.height, windowSize)),
        columns(ceilDivide(frame.width, windowSize)),
        marks(size_t{rows} * columns, marked) {}
  uint8_t at(uint32_t row, uint32_t column) const { return marks[size_t{row} * columns + column]; }
  uint8_t& at(uint32_t row, uint32_t column) { return marks[size_t{row} * columns + column]; }
  size_t count() const { return static_cast<size_t>(std::count(marks.begin(), marks.end(), 1)); }
  bool operator==(const WindowMask&) const = default;

  uint32_t rows, columns;
  std::vector<uint8_t> marks;  // 0 or 1
};

}  // namespace xrds
