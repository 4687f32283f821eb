#ifndef XRDS_SHADERS_CONV3X3_LANES_H
#define XRDS_SHADERS_CONV3X3_LANES_H
#include "shaders/conv3x3/conv3x3.h"

/// What the kernels for CPU devices, conv3x3_lane.comp and conv3x3_turns.comp, compute at a time.
namespace xrds {

/// Of a workgroup. The compiled body grows with outputs * rows; larger ones spread the fetched inputs (outputs) and
/// weights (rows) over more products.
struct LaneTile {
  uint32_t outputs = 0;  // 0: the device takes the plain kernel
  uint32_t maxRows = 0;  // of a lane
  uint32_t pixels = 0;   // of a row: Winograd's F(pixels, 3)
  bool inTurns = false;  // conv3x3_turns.comp
};

/// KernelShape::rows that asks for conv3x3_turns.comp.
constexpr uint32_t kConv3x3InTurns = 8;

LaneTile laneTile(const Conv3x3& op, const DeviceTraits& device);

/// Texels of the weights of a tile and four inputs, in whole subgroups.
uint32_t weightTexels(const LaneTile& tile, uint32_t lanes);

struct LaneGroup {
  uint32_t rows = 0;                        // of a lane
  uint32_t across = 0, down = 0;            // subgroups of a workgroup, side by side and below each other
  uint32_t countAcross = 0, countDown = 0;  // workgroups
};

/// Of so many rows of the convolution. No subgroup is left over: it would repeat the last pixels, and add the residual
/// twice where that is the output.
LaneGroup laneGroup(const Conv3x3& op, const LaneTile& tile, uint32_t rowCount, const DeviceTraits& device);

}  // namespace xrds
#endif
