#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/frame.h"

namespace xrds {

/// How a frame moves, at its full resolution, as TemporalFilter takes it. Empty what the files do not tell.
struct FrameMotion {
  std::vector<float> toPrevious, toNext;  // two floats a pixel, x to the right and y down, in pixels
  std::vector<float> depth;
  bool byCameras = false;  // the files beside it have to tell
};

/// Which motion is asked for.
struct MotionRequest {
  std::string layer{};  // as AovRequest has it; empty: Cycles' pass "Vector", or that of the camera
  std::string depth{};  // the layer of distances; empty: the one found by convention, if any
  std::filesystem::path previous{}, next{};  // the auxiliary files beside it, whether or not they are there
};

/// Reads the motion of a frame from its auxiliary file. Of a layer, four channels are Cycles' (X, Y): previous less
/// present, (Z, W): present less next, in pixels and Y up; two are x to the right and y down from the present to the
/// previous frame. Of several layers of that name the one of the colour's view layer and view is taken, and the same
/// holds for the depth. Without a layer it is that of the camera (cameraMotion()), if this and the file beside it tell
/// where that stood and there is a depth. Throws Error if there is neither, if several layers fit equally well, or the
/// layer does not have the size of the auxiliary images.
FrameMotion readMotion(const Frame& frame, const MotionRequest& request);

}  // namespace xrds
