#pragma once

#include "image/box.h"
#include "image/exr/file.h"

namespace xrds {

/// How an auxiliary part lies over a colour part: their scale, and the windows of the frame that comes out.
struct FrameFit {
  int scale = 1;
  Box dataWindow;
  Box displayWindow;

  bool operator==(const FrameFit&) const = default;
};

/// Compares the display windows, whose ratio is the scale. All parts of one file must share a display window, though;
/// if it is the same for both parts while their data windows differ by a whole factor, that factor is the scale, and
/// the shared window is taken to be that of the part whose data window it equals. Throws Error when there is no whole
/// scale or the result does not fit in 32 bits.
FrameFit fitFrame(const ExrPart& color, const ExrPart& auxiliary);

}  // namespace xrds
