// Planes 6 i + j of a square = (B^T d B)[i][j] of the 6 x 6 pixels d around its 4 x 4, see winograd.h.
// source: [h, w, c], or upsampled [h / 2, w / 2, c], each pixel of which is 2 x 2 of the image's; target: [ceil(h / 4), w / 4,
// 36 c] slices. An invocation makes four channels of a square. Lane: invocations follow each other as SquareQuad says; those
// behind the last of the row repeat it. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/winograd.glsl"
#include "shaders/winograd_input/winograd_input.h"
layout(binding = 0) uniform samplerBuffer source;
#ifdef XRDS_LANE
layout(local_size_x_id = 0, local_size_y_id = 1) in;  // x = subgroup size
layout(constant_id = 2) const bool kUpsampled = false;
#define PARAMS WinogradInputParams
#define TARGET_BINDING 1
#include "shaders/common/uniform_store.glsl"
#else
#include "shaders/common/storage.glsl"
layout(local_size_x = 16, local_size_y = 4) in;
layout(constant_id = 0) const bool kUpsampled = false;
layout(binding = 1, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { WinogradInputParams p; };
#endif

// Rows and columns of the image that the square reads: of those outside, any, as zero.
struct Reach {
  int texel[6];
  bool isInside[6];
};

Reach reach(uint square, uint end, uint step) {
  Reach r;
  [[unroll]] for (uint i = 0; i < 6; i++) {
    const int at = int(4 * square + i) - 1, inside = clamp(at, 0, int(end) - 1);
    r.isInside[i] = at == inside;
    r.texel[i] = (kUpsampled ? inside / 2 : inside) * int(step);
  }
  return r;
}

// Of an upsampled image elements 1 and 2 are the same pixel, and so are 3 and 4.
bool isRepeated(uint element) { return kUpsampled && (element == 2 || element == 4); }

vec4[36] planes(uint column, uint row, uint quad) {
  const uint rowWidth = kUpsampled ? p.width / 2 : p.width;
  const Reach x = reach(column, p.seenWidth, p.source.stride), y = reach(row, p.height, rowWidth * p.source.stride);
  vec4 rows[6][6], made[36];
  [[unroll]] for (uint i = 0; i < 6; i++) {
    if (isRepeated(i)) {
      rows[i] = rows[i - 1];
      continue;
    }
    vec4 d[6];
    [[unroll]] for (uint j = 0; j < 6; j++) {
      if (isRepeated(j)) {
        d[j] = d[j - 1];
        continue;
      }
      const vec4 v = texelFetch(source, y.texel[i] + x.texel[j] + int(p.source.offset + quad));
      d[j] = y.isInside[i] && x.isInside[j] ? v : vec4(0);
    }
    rows[i] = winogradInput(d);
  }
  [[unroll]] for (uint j = 0; j < 6; j++) {
    const vec4 column[6] = winogradInput(vec4[](rows[0][j], rows[1][j], rows[2][j], rows[3][j], rows[4][j], rows[5][j]));
    [[unroll]] for (uint i = 0; i < 6; i++) made[6 * i + j] = column[i];
  }
  return made;
}

void main() {
  const uint targetStart = p.target.offset - p.storeOrigin;
#ifdef XRDS_LANE
  const uint last = p.squares * p.quads - 1;
  const uint chunk = gl_WorkGroupID.x * gl_WorkGroupSize.y + gl_LocalInvocationID.y;
  const SquareQuad own = squareQuad(min(chunk * kLanes + gl_LocalInvocationID.x, last), p.quads);
  const vec4 made[36] = planes(own.square, p.rowBegin + gl_WorkGroupID.y, own.quad);
  const uint first = (uniformOf(gl_WorkGroupID.x, 4) * gl_WorkGroupSize.y + uniformOf(gl_LocalInvocationID.y, 2)) * kLanes;
  const uint rowStart = (p.rowBegin + uniformOf(gl_WorkGroupID.y, 4)) * p.squares;
  uint laneStart[kLanes];
  [[unroll]] for (uint l = 0; l < kLanes; l++) {
    const SquareQuad item = squareQuad(min(first + l, last), p.quads);
    laneStart[l] = (rowStart + item.square) * p.target.stride + targetStart + item.quad;
  }
  [[unroll]] for (uint e = 0; e < 36; e++) {
    const WIDE4 wide = wide4(made[e]);
    [[unroll]] for (uint l = 0; l < kLanes; l++) storeLane(laneStart[l] + e * p.quads, wide, l);
  }
#else
  const uint quad = gl_WorkGroupID.x * gl_WorkGroupSize.y + gl_LocalInvocationID.y, row = p.rowBegin + gl_WorkGroupID.z;
  const uint column = gl_WorkGroupID.y * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (column >= p.squares || quad >= p.quads) return;
  const vec4 made[36] = planes(column, row, quad);
  for (uint e = 0; e < 36; e++)
    target[(row * p.squares + column) * p.target.stride + targetStart + e * p.quads + quad] = stored4(made[e]);
#endif
}
