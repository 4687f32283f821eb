#ifndef XRDS_SHADERS_CONV3X3_SIDES_H
#define XRDS_SHADERS_CONV3X3_SIDES_H
#include "shaders/conv3x3/conv3x3.h"

/// Sides and channels of a convolution as its kernels see them.
namespace xrds {

inline uint32_t parts(bool shuffled) { return shuffled ? 4 : 1; }
inline uint32_t factor(bool shuffled) { return shuffled ? 2 : 1; }

// Channels that the kernels see: those of the views, all parts of a shuffled one.
inline uint32_t kernelInputs(const Conv3x3& op) { return op.input.channels * parts(op.unshuffleInput); }
inline uint32_t kernelOutputs(const Conv3x3& op) { return outputShape(op).channels * parts(op.shuffleOutput); }

inline TensorShape convolutionShape(const Conv3x3& op) {
  const uint32_t f = factor(op.unshuffleInput);
  return {op.input.height / f, op.input.width / f, op.outputChannels};
}

inline uint32_t seenColumns(const Conv3x3& op) {
  return op.seenColumns > 0 ? op.seenColumns : convolutionShape(op).width;
}

}  // namespace xrds
#endif
