#pragma once

#include "network/layers.h"

namespace xrds {

/// The low-resolution branch up to the upscaling: F_0 = conv3x3(x), F_g = XDG_g(F_{g-1}, D_{g-1}), then
/// U = conv3x3([F_N, D_N]), U = conv3x3(U) + F_0. x is [h, w, 4], d holds D_0 .. D_N, [h, w, C] each, or nothing.
/// Returns U. The chains of attention and linear maps go over bands of rows.
TensorView lowResolutionBranch(Layers& layers, TensorView x, const std::vector<TensorView>& d);

}  // namespace xrds
