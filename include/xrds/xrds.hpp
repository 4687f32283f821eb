#pragma once

#include "xrds/auxiliary_input.h"
#include "xrds/device.h"
#include "xrds/error.h"
#include "xrds/layers.h"
#include "xrds/merged_colour.h"
#include "xrds/mirror.h"
#include "xrds/model.h"
#include "xrds/pixel_view.h"
#include "xrds/precision.h"
#include "xrds/preparation.h"
#include "xrds/relative_depth.h"
#include "xrds/shipped_models.h"
#include "xrds/skip.h"
#include "xrds/temporal_filter.h"
#include "xrds/tiling.h"
#include "xrds/upscaler.h"

/// xrds upscales Monte Carlo renders on any Vulkan device: open a Device, load a Model, make an Upscaler for a frame
/// size, run it for each frame. Every function may throw Error; an object is used by one thread at a time.
namespace xrds {}
