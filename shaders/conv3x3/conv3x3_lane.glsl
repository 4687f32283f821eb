// What the kernels for CPU devices share. A lane computes kRows rows of kPixels pixels (lanes behind the last repeat it) by
// Winograd's F(kPixels, 3) along x, kTile outputs of them.
#ifndef XRDS_SHADERS_CONV3X3_LANE_GLSL
#define XRDS_SHADERS_CONV3X3_LANE_GLSL
#include "shaders/common/activation.glsl"
#include "shaders/conv3x3/conv3x3.h"
layout(local_size_x_id = 0, local_size_y_id = 5) in;  // x = subgroup size; y: subgroups
#define PARAMS Conv3x3Params
#define TARGET_BINDING 3
#include "shaders/common/uniform_store.glsl"
layout(constant_id = 1) const uint kRows = 4;
layout(constant_id = 2) const uint kTile = 4;
layout(constant_id = 3) const uint kActivation = kActivationNone;
layout(constant_id = 4) const bool kHasResidual = false;
#include "shaders/conv3x3/winograd.glsl"
const uint kTileQuads = kTile / 4;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2) uniform samplerBuffer residual;

// The lane's first pixel, and the texels around it.
uint column, row;
int rowTexel[kRows + 2], columnTexel[kElements];
bool hasRow[kRows + 2], hasColumn[kElements];

// Of subgroup `across` of the row and `down` of the column.
void findInputs(uint across, uint down) {
  column = min(kPixels * (across * kLanes + gl_LocalInvocationID.x), p.width - kPixels);
  row = p.rowBegin + down * kRows;
  [[unroll]] for (uint i = 0; i < kRows + 2; i++) {
    const int y = int(row + i) - 1, inside = clamp(y, 0, int(p.height) - 1);
    hasRow[i] = y == inside;
    rowTexel[i] = int(inside * p.unshuffle * p.width * p.unshuffle * p.source.stride + p.source.offset);
  }
  [[unroll]] for (uint i = 0; i < kElements; i++) {
    const int x = int(column + i) - 1, inside = clamp(x, 0, int(p.seenWidth) - 1);
    hasColumn[i] = x == inside;
    columnTexel[i] = int(inside * p.unshuffle * p.source.stride);
  }
}

// Row i of the inputs, transformed; `shift` from a pixel's first channels to those that are asked for.
vec4[kElements] elementsOf(uint i, int shift) {
  vec4 d[kElements];
  [[unroll]] for (uint j = 0; j < kElements; j++) {
    const vec4 v = texelFetch(source, rowTexel[i] + columnTexel[j] + shift);
    d[j] = hasRow[i] && hasColumn[j] ? v : vec4(0);
  }
  return transformed(d);
}

// What all lanes of the subgroup know of the target: the first pixel of the first lane, and the tile's first quad.
uvec2 corner;
uint firstQuad;
uint laneOffset[kLanes];  // of a lane's first pixel

void findTarget(uint across, uint down) {
  corner = uvec2(kPixels * kLanes * uniformOf(across, 4), p.rowBegin + uniformOf(down, 4) * kRows);
  firstQuad = uniformOf(gl_WorkGroupID.x, 2) * kTileQuads;
}

void findLanes() {
  [[unroll]] for (uint l = 0; l < kLanes; l++)
    laneOffset[l] = (min(corner.x + kPixels * l, p.width - kPixels) - corner.x) * p.shuffle * p.target.stride;
}

// Stores pixel h of row i, quad n of the tile.
void store(vec4 sum, uint i, uint h, uint n) {
  // Of a shuffled output, the pixel of four that the channels belong to; a division would be done lane by lane.
  const uint targetQuads = p.outputChannels / 4, targetWidth = p.width * p.shuffle;
  const uint part = uint(firstQuad + n >= targetQuads) + uint(firstQuad + n >= 2 * targetQuads) +
                    uint(firstQuad + n >= 3 * targetQuads);
  const uint quad = firstQuad + n - part * targetQuads;
  const uvec2 own = uvec2(column + h, row + i) * p.shuffle + uvec2(part % 2, part / 2);
  const uvec2 first = uvec2(corner.x + h, corner.y + i) * p.shuffle + uvec2(part % 2, part / 2);
  vec4 y = activate(kActivation, sum);
  if (kHasResidual)
    y += texelFetch(residual, int((own.y * targetWidth + own.x) * p.residual.stride + p.residual.offset + quad));
  const WIDE4 wide = wide4(y);
  const uint at = (first.y * targetWidth + first.x) * p.target.stride + p.target.offset - p.storeOrigin + quad;
  [[unroll]] for (uint l = 0; l < kLanes; l++) storeLane(at + laneOffset[l], wide, l);
}

#endif
