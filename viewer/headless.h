#pragma once

#include "viewer/viewer.h"

namespace xrds {

/// The live loop without a display: traces the scene from a camera that goes round, upscales it, and leaves the
/// pictures on the device, `options.frames` of them after some that do not count. Prints how long each stage took and
/// how many pictures a second that makes. Throws Failure.
void runHeadless(const ViewerOptions& options);

}  // namespace xrds
