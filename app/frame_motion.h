#pragma once

#include <string>
#include <vector>

#include "app/frame.h"

namespace xrds {

/// How a frame moves, at its full resolution, as TemporalFilter takes it. Empty what the file does not have.
struct FrameMotion {
  std::vector<float> toPrevious, toNext;  // two floats a pixel, x to the right and y down, in pixels
  std::vector<float> depth;
};

/// Reads the motion of a frame from its auxiliary file. `layer` names it as AovRequest has it; empty: Cycles' pass
/// "Vector". Four channels are Cycles' (X, Y): previous less present, (Z, W): present less next, in pixels and Y up;
/// two are x to the right and y down from the present to the previous frame. `depth` names the layer of distances;
/// empty: the one found by convention, if there is one. Throws Error if there is no such layer, or it does not have the
/// size of the auxiliary images.
FrameMotion readMotion(const Frame& frame, const std::string& layer, const std::string& depth);

}  // namespace xrds
