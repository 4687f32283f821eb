#pragma once

#include <string>
#include <vector>

#include "graph/graph.h"

namespace xrds {

/// The steps in which stages make an image from top to bottom, some rows a step, so that no stage's tensor need be
/// there as a whole. A stage that reads rows below its own stays a distance behind the one that makes them.
struct Sweep {
  uint32_t height = 0;    // of the image
  uint64_t bandRows = 0;  // rows a step; the whole image is made in one if there are enough

  /// The rows that a stage makes in a step, none (begin = end) before its turn and after its end.
  RowRange rows(uint32_t step, uint32_t distance) const;
  /// Steps until a stage at that distance is done.
  uint32_t stepCount(uint32_t distance) const;
};

/// A tensor of an image of which a sweep keeps a band of rows.
class RollingTensor {
 public:
  RollingTensor() = default;
  RollingTensor(std::string name, DataType type, TensorShape shape)
      : name_(std::move(name)), type_(type), shape_(shape) {}

  /// Makes place for the rows that a step makes and carries over those from `keep` on that earlier steps made.
  /// Returns the view of the image with these rows.
  TensorView advance(Graph& graph, RowRange made, uint32_t keep);
  const TensorView& view() const { return view_; }

 private:
  std::string name_;
  DataType type_ = DataType::f32;
  TensorShape shape_;
  TensorView view_;
};

/// Rows of an image that a chain of operators works on together, as an image of its own: rows of windows of attention.
struct WindowBand {
  RowRange rows;
  uint32_t height = 0;   // of the image
  uint32_t endRows = 0;  // not 0: the band is the first `endRows` rows and the last of the image, which a cyclic
                         // shift joins to one row of windows, and `rows` counts within it
  bool isWhole() const { return endRows == 0 && rows.end - rows.begin == height; }
};

/// The bands of an image of `height` rows under attention in windows, cyclically shifted by `shift` rows.
std::vector<WindowBand> windowBands(uint32_t height, uint32_t window, uint32_t shift, uint64_t bandRows);

/// The rows of the band as an image of their own: a view, or a copy of those that a shift joins.
TensorView takeRows(Graph& graph, const std::string& name, const WindowBand& band, const TensorView& image);

/// Where an operator on the band writes its rows of the image; giveRows() then brings copied ones to their place.
TensorView rowsToWrite(Graph& graph, const std::string& name, const WindowBand& band, const TensorView& image);
void giveRows(Graph& graph, const std::string& name, const WindowBand& band, const TensorView& rows,
              const TensorView& image);

/// Adds a node that copies `rows` of one view to the other.
void copyRows(Graph& graph, const std::string& name, const TensorView& from, const TensorView& to, RowRange rows = {});

}  // namespace xrds
