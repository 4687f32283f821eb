#pragma once

#include "network/layers.h"

namespace xrds {

/// What the auxiliary branch hands on.
struct AuxiliaryFeatures {
  std::vector<TensorView> d;  // D_0 .. D_N, [h, w, C]
  TensorView h{};             // H_N, [s h, s w, Ca], of a model that feeds it to the output convolution
};

/// The auxiliary branch on the packed auxiliary images [s h, s w, ceil4(A)], which runs at high resolution, in bands:
/// H_0 = conv3x3(aux); H_i = H_{i-1} + conv3x3(relu(conv3x3(H_{i-1}))); D_i = deshuffle_i(H_i).
AuxiliaryFeatures auxiliaryBranch(Layers& layers, TensorView aux);

}  // namespace xrds
