#pragma once

#include "network/config.h"

namespace xrds {

/// How far the network sees: low-resolution pixels, whole windows, that a crop of the frame needs around the part of it
/// that shall equal the frame's result bit for bit, where the crop begins and ends at multiples of the window or at the
/// frame's border. Follows the forward pass of network.cpp layer by layer.
uint32_t exactHalo(const NetworkConfig& config);

/// The halo of bounded tiles, two windows and at most exactHalo(): `xrds bench tiles` measures the error that it
/// leaves.
uint32_t boundedHalo(const NetworkConfig& config);

}  // namespace xrds
