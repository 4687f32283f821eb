#pragma once

#include "cli/upscale_options.h"

namespace xrds {

/// Whether the options name many frames. Throws Failure where options of sequences are given without one.
bool isSequence(const UpscaleOptions& options);

/// Upscales all frames: reading, computing and writing of different frames at once, each output whole or not at all.
/// Throws Failure: with ExitCode::frames if some could not be made and all others were.
void upscaleSequence(const UpscaleOptions& options);

}  // namespace xrds
