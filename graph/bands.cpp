#include "graph/bands.h"

#include <algorithm>

namespace xrds {

RowRange Sweep::rows(uint32_t step, uint32_t distance) const {
  const auto first = [&](uint64_t n) {
    const uint64_t made = n * std::min<uint64_t>(bandRows, uint64_t{height} + distance);
    return static_cast<uint32_t>(std::min<uint64_t>(made - std::min<uint64_t>(made, distance), height));
  };
  return {first(step), first(uint64_t{step} + 1)};
}

uint32_t Sweep::stepCount(uint32_t distance) const {
  const uint64_t rows = uint64_t{height} + distance;
  return ceilDivide(rows, std::min(bandRows, rows));
}

TensorView RollingTensor::advance(Graph& graph, RowRange made, uint32_t keep) {
  XRDS_CHECK_LE(keep, made.begin);
  const TensorView before = view_;
  view_ = graph.createRows(name_, type_, shape_, {keep, made.end});
  if (keep == made.begin) return view_;
  XRDS_CHECK_LE(before.firstRow, static_cast<int32_t>(keep));
  copyRows(graph, name_ + ".carried", before, view_, {keep, made.begin});
  return view_;
}

std::vector<WindowBand> windowBands(uint32_t height, uint32_t window, uint32_t shift, uint64_t bandRows) {
  if (bandRows >= height) return {{{0, height}, height}};
  const auto step = static_cast<uint32_t>(std::max<uint64_t>(window, bandRows / window * window));
  std::vector<WindowBand> bands;
  if (shift > 0) bands.push_back({{0, window}, height, shift});
  const uint32_t end = shift > 0 ? height - (window - shift) : height;
  for (uint32_t row = shift; row < end; row += step) bands.push_back({{row, std::min(row + step, end)}, height});
  return bands;
}

TensorView rowsToWrite(Graph& graph, const std::string& name, const WindowBand& band, const TensorView& image) {
  if (band.isWhole()) return image;
  if (band.endRows == 0) return rowsOf(image, band.rows);
  return graph.create(name, image.type, {band.rows.end, image.width, image.channels});
}

TensorView takeRows(Graph& graph, const std::string& name, const WindowBand& band, const TensorView& image) {
  const TensorView rows = rowsToWrite(graph, name, band, image);
  if (band.endRows == 0) return rows;
  const uint32_t last = band.rows.end - band.endRows;
  copyRows(graph, name, rowsOf(image, {0, band.endRows}), rowsOf(rows, {0, band.endRows}));
  copyRows(graph, name, rowsOf(image, {band.height - last, band.height}), rowsOf(rows, {band.endRows, band.rows.end}));
  return rows;
}

void giveRows(Graph& graph, const std::string& name, const WindowBand& band, const TensorView& rows,
              const TensorView& image) {
  if (band.endRows == 0) return;
  const uint32_t last = band.rows.end - band.endRows;
  copyRows(graph, name, rowsOf(rows, {0, band.endRows}), rowsOf(image, {0, band.endRows}));
  copyRows(graph, name, rowsOf(rows, {band.endRows, band.rows.end}), rowsOf(image, {band.height - last, band.height}));
}

void copyRows(Graph& graph, const std::string& name, const TensorView& from, const TensorView& to, RowRange rows) {
  graph.nodes.push_back({name, BoxMean{.input = from, .output = to, .scale = 1, .rows = rows}});
}

}  // namespace xrds
