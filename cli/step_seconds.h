#pragma once

#include <cstddef>

#include "advice/plans.h"
#include "xrds/xrds.hpp"

namespace xrds {

/// Times on pieces of frames what making a picture of `pixels` full-resolution pixels takes on the device: each shipped
/// model of the ways, and the denoiser, if one is installed. Throws Error.
StepSeconds measureSteps(Device& device, const std::vector<Way>& ways, size_t pixels);

}  // namespace xrds
