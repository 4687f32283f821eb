#include "shaders/conv3x3/lanes.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "shaders/common/uniform_store.h"
#include "shaders/conv3x3/sides.h"

namespace xrds {
namespace {

constexpr uint32_t kMaxSubgroups = 4;                // of a workgroup of the lane kernel, side by side
constexpr uint32_t kLeastTurns = 4, kMaxTurns = 16;  // subgroups that take turns
constexpr uint32_t kTurnRows = 2;                    // of a lane of them

// The largest multiple of `step` that divides `channels` and is at most `limit`.
uint32_t largestDivisor(uint32_t channels, uint32_t step, uint32_t limit) {
  uint32_t divisor = std::min(channels, limit) / step * step;
  while (channels % divisor != 0) divisor -= step;
  return divisor;
}

// Whether the weights of the tile fit in shared memory, and the code does not take too long to compile.
bool canTakeTurns(const Conv3x3& op, const LaneTile& tile, const DeviceTraits& device) {
  constexpr uint32_t kMaxBody = 12288, kLeastChannels = 8;  // body: multiply-adds of a lane
  const uint32_t inputs = op.input.channels, body = 3 * (tile.pixels + 2) * inputs * tile.outputs * kTurnRows;
  const uint32_t texels = inputs / 4 * weightTexels(tile, device.subgroupSize) + tile.outputs / 4;
  return !op.unshuffleInput && std::min(inputs, tile.outputs) >= kLeastChannels && body <= kMaxBody &&
         texels * 16 <= device.maxSharedBytes && device.subgroupSize * kMaxTurns <= device.maxGroupInvocations;
}

// Subgroups that take turns: the transformed inputs of all of them stay in a quarter of the second-level cache.
uint32_t turnsOf(const Conv3x3& op, const LaneTile& tile, const DeviceTraits& device) {
  constexpr uint32_t kCacheShare = 4;
  const uint64_t elements = uint64_t{kTurnRows + 2} * (tile.pixels + 2) * op.input.channels;
  const uint64_t fit =
      device.secondCacheBytes / kCacheShare / (elements * device.subgroupSize * byteSize(DataType::f32));
  return static_cast<uint32_t>(std::clamp<uint64_t>(fit, kLeastTurns, kMaxTurns));
}

}  // namespace

uint32_t weightTexels(const LaneTile& tile, uint32_t lanes) {
  return alignUp(3 * (tile.pixels + 2) * tile.outputs, lanes);
}

// fp16 weights are too coarse for F(4, 3): its transform adds two thirds to their rounding, that of F(2, 3) a third.
LaneTile laneTile(const Conv3x3& op, const DeviceTraits& device) {
  const uint32_t outputs = kernelOutputs(op), step = outputShape(op).channels % 8 ? 4 : 8;
  const uint32_t width = convolutionShape(op).width;
  if (device.family != KernelFamily::lane || !device.shaderInt64 || width % 2 != 0 ||
      device.subgroupSize * kMaxSubgroups > device.maxGroupInvocations)
    return {};
  LaneTile tile{largestDivisor(outputs, step, 16), 4, 2};
  if (tile.outputs < 8 && outputs >= 8) tile.outputs = largestDivisor(outputs, step, 32), tile.maxRows = 3;
  const KernelShape& asked = device.shape;
  const bool isAsked = asked.outputs % step == 0 && asked.outputs > 0 && outputs % asked.outputs == 0;
  if (isAsked) tile.outputs = asked.outputs;
  if (isAsked && asked.rows > 0) tile.maxRows = std::min(asked.rows, 4u);
  if (op.inFours && width % 4 == 0 && op.weightType == DataType::f32)
    tile.pixels = 4, tile.maxRows = std::min(tile.maxRows, 2u);
  // With vectors of 512 bits they gain 2 % of a frame's convolutions, and compile for 4 s more.
  const bool wantsTurns = isAsked ? asked.rows == kConv3x3InTurns : gainsByTurns(device);
  tile.inTurns = wantsTurns && canTakeTurns(op, tile, device);
  if (tile.inTurns) tile.maxRows = kTurnRows;
  return tile;
}

LaneGroup laneGroup(const Conv3x3& op, const LaneTile& tile, uint32_t rowCount, const DeviceTraits& device) {
  LaneGroup group{.rows = evenShare(rowCount, tile.maxRows), .down = 1};
  const uint32_t columns = ceilDivide(convolutionShape(op).width, tile.pixels * device.subgroupSize);
  const uint32_t rows = rowCount / group.rows;
  if (tile.inTurns) {
    // Powers of two, of a frame's width alone if that is divided well: few programs.
    const uint32_t turns = std::bit_floor(turnsOf(op, tile, device));
    group.across = std::gcd(columns, turns);
    if (group.across < kLeastTurns) group.down = std::gcd(rows, turns / group.across);
  } else {
    group.across = subgroupShare(columns, kMaxSubgroups);
  }
  group.countAcross = columns / group.across;
  group.countDown = rows / group.down;
  return group;
}

}  // namespace xrds
