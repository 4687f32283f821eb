#pragma once

#include "cli/denoise_frame.h"

namespace xrds {

/// Denoises all frames that the options name, as upscaleSequence() does. Throws Failure.
void denoiseSequence(const DenoiseOptions& options);

}  // namespace xrds
