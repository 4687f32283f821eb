#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/check.h"

namespace xrds {

/// Element type of a stored tensor; arithmetic is 32-bit float in either case.
enum class DataType : uint8_t { f32, f16 };

constexpr uint32_t byteSize(DataType type) { return type == DataType::f32 ? 4 : 2; }

/// Names one stored value of a graph: a byte range of the arena that the planner places.
using ValueId = uint32_t;
inline constexpr ValueId kNoValue = ~ValueId{0};
/// Stands for the packed weights of the dispatch that names it.
inline constexpr ValueId kWeights = ~ValueId{1};

struct TensorShape {
  uint32_t height = 0, width = 0, channels = 0;
  bool operator==(const TensorShape&) const = default;
};

/// Half-open range of rows; end 0 means all rows.
struct RowRange {
  uint32_t begin = 0, end = 0;
  bool operator==(const RowRange&) const = default;
};

/// A channel slice of a stored NHWC tensor (N = 1). A pixel takes `channelStride` elements, of which `channels`
/// from `channelOffset` on belong to the view. All three are multiples of 4, so that a pixel is a run of vec4.
/// The rows of the view are an image; those stored may be a band of it, or the image may be a part of those stored.
struct TensorView {
  ValueId value = kNoValue;
  DataType type = DataType::f32;
  uint32_t height = 0, width = 0, channels = 0, channelOffset = 0, channelStride = 0;
  int32_t firstRow = 0;       // of the view, stored first; negative if rows are stored above it
  uint32_t storedHeight = 0;  // rows of the stored tensor; 0: those of the view

  bool exists() const { return value != kNoValue; }
  TensorShape shape() const { return {height, width, channels}; }
  uint64_t pixelCount() const { return uint64_t{height} * width; }
  uint32_t storedRows() const { return storedHeight ? storedHeight : height; }
  /// Elements and bytes of the whole stored tensor, of which the view may be a slice.
  uint64_t storedElementCount() const { return uint64_t{storedRows()} * width * channelStride; }
  uint64_t storedByteSize() const { return storedElementCount() * xrds::byteSize(type); }
  uint64_t rowByteSize() const { return uint64_t{width} * channelStride * xrds::byteSize(type); }
  /// The row of the stored tensor that holds row y of the view, or the end of row y - 1. Throws std::logic_error if
  /// there is none.
  uint64_t storedRow(uint32_t y) const {
    const int64_t row = int64_t{y} - firstRow;
    XRDS_CHECK_LE(0, row);
    XRDS_CHECK_LE(row, int64_t{storedRows()});
    return static_cast<uint64_t>(row);
  }
  /// The vec4 of the stored tensor at which row 0 begins; modulo 2^32 where that row is not stored.
  uint32_t firstTexel() const {
    return channelOffset / 4 - static_cast<uint32_t>(firstRow) * width * (channelStride / 4);
  }
};

/// The view of `channels` channels from `offset` on inside `view`.
inline TensorView slice(TensorView view, uint32_t offset, uint32_t channels) {
  XRDS_CHECK_LE(offset + channels, view.channels);
  view.channelOffset += offset;
  view.channels = channels;
  return view;
}

/// The rows of the view as an image of their own.
inline TensorView rowsOf(TensorView view, RowRange rows) {
  XRDS_CHECK_LE(rows.end, view.height);
  view.storedHeight = view.storedRows();
  view.firstRow -= static_cast<int32_t>(rows.begin);
  view.height = rows.end - rows.begin;
  return view;
}

/// The view as rows `firstRow` and on of an image of that height; the opposite of rowsOf().
inline TensorView asRowsOf(TensorView view, uint32_t height, uint32_t firstRow) {
  XRDS_CHECK_LE(firstRow + view.height, height);
  view.storedHeight = view.storedRows();
  view.firstRow += static_cast<int32_t>(firstRow);
  view.height = height;
  return view;
}

/// Throws std::logic_error unless the view keeps the vec4 rule and has the shape.
inline void checkView(const TensorView& view, const TensorShape& shape) {
  XRDS_CHECK(view.exists());
  XRDS_CHECK_EQ(view.height, shape.height);
  XRDS_CHECK_EQ(view.width, shape.width);
  XRDS_CHECK_EQ(view.channels, shape.channels);
  XRDS_CHECK_EQ((view.channels | view.channelOffset | view.channelStride) % 4, 0u);
  XRDS_CHECK_LE(view.channelOffset + view.channels, view.channelStride);
}

inline RowRange resolve(RowRange rows, uint32_t height) {
  if (rows.end == 0) rows.end = height;
  XRDS_CHECK_LT(rows.begin, rows.end);
  XRDS_CHECK_LE(rows.end, height);
  return rows;
}

/// Double-precision storage of a graph's values, on which each operator's reference() works.
class HostMemory {
 public:
  /// The element (y, x, c) of the view; c counts from the view's first channel. Throws std::logic_error if the row is
  /// not stored.
  double& at(const TensorView& view, uint32_t y, uint32_t x, uint32_t c) {
    return storage(view).at((view.storedRow(y) * view.width + x) * view.channelStride + view.channelOffset + c);
  }
  double at(const TensorView& view, uint32_t y, uint32_t x, uint32_t c) const {
    return const_cast<HostMemory*>(this)->at(view, y, x, c);
  }
  /// All elements of the stored tensor behind the view, allocated (zero) at first use.
  std::vector<double>& storage(const TensorView& view) { return storage(view.value, view.storedElementCount()); }
  std::vector<double>& storage(ValueId value, size_t elementCount) {
    if (values_.size() <= value) values_.resize(value + 1);
    if (values_[value].empty()) values_[value].resize(elementCount);
    return values_[value];
  }

 private:
  std::vector<std::vector<double>> values_;
};

}  // namespace xrds
