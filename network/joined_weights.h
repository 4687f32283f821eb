#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace xrds {

/// Weights and bias of a convolution, as the model has them: OIHW and [O].
struct ConvWeights {
  std::span<const float> weight, bias;
};

/// The same, made of others in double precision.
struct JoinedWeights {
  std::vector<float> weight, bias;
};

/// A 1x1 convolution of pixel_shuffle(conv3x3(x), 2) as pixel_shuffle of one convolution [4 N'][b][3][3], N' = N
/// rounded up to a multiple of four, zeros above N. `doubling` is [4c][b][3][3], `output` [N][c or more][1][1], of
/// which channels from c on belong to something else.
JoinedWeights joinedWithOutput(ConvWeights doubling, ConvWeights output);

/// A 3x3 convolution of pixel_shuffle(conv3x3(x), 2), with zero padding, as fold() of one convolution [16 N][b][3][3]:
/// what a pixel of x's resolution adds to the 4 x 4 pixels around the 2 x 2 that it becomes (see Fold). `output` is
/// [N][c][3][3]; its bias is added in the middle of the patch, of which each pixel is just once.
JoinedWeights joinedAsPatches(ConvWeights doubling, ConvWeights output);

}  // namespace xrds
