#pragma once

#include <string>

#include "graph/graph.h"

namespace xrds {

/// Whether Winograd's filtering in two directions, squares of 4 x 4 pixels at a time, makes the convolution and is
/// worth its two transforms on a CPU device. The same for a frame and for parts of it, but for rows that are
/// too wide to be bound: of 256 channels 13628 pixels. Pure.
bool isWorthSquares(const Conv3x3& op);

/// What a convolution in squares takes and gives in the place of other operators.
struct SquareEnds {
  TensorView upsampled{};  // [h / 2, w / 2, c]: UpsampleNearest of it stands before the channels of the input
  TensorView pooled{};     // [h / 2, w / 2, c]: MaxPool of the result, which alone is stored
};

/// Adds the convolution as three steps: a transform of its input, a linear map of each plane, a transform of the
/// products. Rows of squares are made a band at a time, with the same bits, so that little memory is needed, or all at
/// once. The operator's rows must begin at multiples of 4, and end there or with the image. Its weights are of all
/// channels, those of SquareEnds::upsampled before its input's.
void addInSquares(Graph& graph, const std::string& name, const Conv3x3& op, bool atOnce, const SquareEnds& ends = {});

}  // namespace xrds
