// Between pixels in any buffer of a program that shares its device, and the images of a graph.
#ifndef XRDS_SHADERS_HOST_PIXELS_H
#define XRDS_SHADERS_HOST_PIXELS_H
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
struct TakePixelsParams {
  uint firstWord;                // of the binding, at which row `sourceBegin` begins
  uint rowWords;                 // from a row to the next
  int channels;                  // numbers from a pixel to the next
  int sourceWidth;               // columns, behind which the first one follows
  int sourceBegin, sourceEnd;    // rows that are bound
  int left, top;                 // of the source, where the target's pixel (0, 0) lies
  int width, rowBegin, rowEnd;   // of the target
  int stride, channel, cleared;  // floats from pixel to pixel; the first that is written; zeros behind the three
  int targetOrigin;              // floats of the target before the binding
};

struct GivePixelsParams {
  uint firstWord, rowWords;     // of the binding, at which row `rowBegin` begins
  int channels;                 // 3, or 4 of which the last one is 1 or the source's
  int width, rowBegin, rowEnd;  // that are given
  int sourceWidth, left, top;   // of the source, where pixel (0, 0) lies
  int sourceOrigin;             // pixels of the source before the binding
};

const int kMostRepairRadius = 8;     // how far away a pixel that is not finite looks for ones that are
const float kAlphaRounding = 1e-5f;  // as xrds/alpha.h has it
XRDS_SHARED_END

#ifdef __cplusplus
namespace xrds {

/// Pixels in a buffer: 3 or 4 numbers each, of which three count, or of 1 or 4 the last one as alpha.
struct HostPixels {
  uint64_t byteOffset = 0, rowBytes = 0;  // multiples of 4
  uint32_t width = 0, height = 0, channels = 3;
  DataType type = DataType::f32;
  bool isAlpha = false;

  uint64_t byteSize() const { return (height - 1) * rowBytes + uint64_t{width} * channels * xrds::byteSize(type); }
};

/// Rows of an image from the source's part whose upper left pixel is (left, top), into three channels from `channel`
/// on of the target, f32 [h, w, c], and zeros into as many behind them. Columns are cyclic. A pixel that is not finite
/// becomes the mean of the nearest finite ones, or 0 if there are none within kMostRepairRadius. An alpha becomes each
/// of the three.
struct TakePixels {
  HostPixels source;
  TensorView target;
  int64_t left = 0;
  uint32_t top = 0, channel = 0, cleared = 0;
};

/// Columns and rows of an f32 image [H, W, 4] from (left, top) on, to (x, y) of the target; the fourth channel
/// becomes 1, unless it is to be the source's. Halves are clamped to +-65504. x and left are even. Of an alpha the
/// target's fourth channel is written alone: the source's first one, as snappedAlpha() has it.
struct GivePixels {
  TensorView source;
  HostPixels target;
  uint32_t left = 0, top = 0, x = 0, y = 0, width = 0, height = 0;
  bool marksLost = false;  // the fourth channel is the source's
};

/// The launches, in bands of rows that the device can bind: value 0 is the program's buffer, value 1 the graph's, whose
/// view begins at its byte 0. Pure.
std::vector<Dispatch> dispatches(const TakePixels& take, const DeviceTraits& device);
std::vector<Dispatch> dispatches(const GivePixels& give, const DeviceTraits& device);

/// From one float e of value 0 to (e, 1 / e, 0, 0) of value 1; what is not between 1e-30 and 1e30 counts as 1.
Dispatch takeExposure(uint64_t byteOffset);

}  // namespace xrds
#endif
#endif
