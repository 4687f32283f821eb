#pragma once

#include "cli/upscale_options.h"

namespace xrds {

/// Upscales all frames that the options name (runSequence()). Throws Failure.
void upscaleSequence(const UpscaleOptions& options);

}  // namespace xrds
