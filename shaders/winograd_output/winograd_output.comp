// y = activation(A^T m A + b) + residual: 4 x 4 pixels of the 36 products m of a square, see winograd.h.
// source: [ceil(h / 4), w / 4, 36 c] slices, residual, y: [h, w, c] slices, if shuffled [2h, 2w, c / 4], if pooled the largest
// of 2 x 2 pixels each, [h / 2, w / 2, c];
// weights: bias[c]. An invocation makes four channels of a square. Lane: invocations follow each other as SquareQuad
// says; those behind the last of the row repeat it. Rows behind the last are stored before those above, to the last. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/activation.glsl"
#include "shaders/common/winograd.glsl"
#include "shaders/winograd_output/winograd_output.h"
layout(constant_id = 0) const uint kActivation = kActivationNone;
layout(constant_id = 1) const bool kHasResidual = false;
layout(constant_id = 2) const bool kPooled = false;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2) uniform samplerBuffer residual;
#ifdef XRDS_LANE
layout(local_size_x_id = 3, local_size_y_id = 4) in;  // x = subgroup size
#define PARAMS WinogradOutputParams
#define TARGET_BINDING 3
#include "shaders/common/uniform_store.glsl"
#else
#include "shaders/common/storage.glsl"
layout(local_size_x = 16, local_size_y = 4) in;
layout(binding = 3, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { WinogradOutputParams p; };
#endif

// Where a quad of the planes is stored: its quad in the target, and the pixel of a shuffled one's four. A division would be
// done lane by lane.
struct Place {
  uint quad, x, y;
};
Place placeOf(uint quad) {
  const uint part = uint(quad >= p.targetQuads) + uint(quad >= 2 * p.targetQuads) + uint(quad >= 3 * p.targetQuads);
  return Place(quad - part * p.targetQuads, part % 2, part / 2);
}

// The stored pixel of the convolution's, and how far behind it that of a place is.
uint pixelAt(uint x, uint y) { return y * p.shuffle * p.width * p.shuffle + x * p.shuffle; }
uint pixelsTo(Place place) { return place.y * p.width * p.shuffle + place.x; }

// The same of a pooled one.
uint pooledAt(uint x, uint y) { return y / 2 * (p.width / 2) + x; }

// Pixel (h, v) of the four that a square is pooled to.
vec4 pooledPixel(vec4 made[16], uint h, uint v) {
  const uint i = 8 * v + 2 * h;
  return max(max(made[i], made[i + 1]), max(made[i + 4], made[i + 5]));
}

uint rowOf(uint squareRow, uint v) { return min(p.rowBegin + 4 * squareRow + v, p.rowEnd - 1); }

// Pixel (h, v) is 4 v + h. `row` counts from the dispatch's first.
vec4[16] pixels(uint column, uint row, uint quad) {
  const uint square = (p.rowBegin / 4 + row) * p.squares + column;
  const int start = int(square * p.source.stride + p.source.offset + quad);
  vec4 rows[6][4], made[16];
  [[unroll]] for (uint i = 0; i < 6; i++) {
    vec4 m[6];
    [[unroll]] for (uint j = 0; j < 6; j++) m[j] = texelFetch(source, start + int((6 * i + j) * p.quads));
    [[unroll]] for (uint h = 0; h < 4; h++) rows[i][h] = winogradResult(m, h);
  }
  const vec4 bias = texelFetch(weights, int(quad));
  [[unroll]] for (uint h = 0; h < 4; h++) {
    const vec4 m[6] = vec4[](rows[0][h], rows[1][h], rows[2][h], rows[3][h], rows[4][h], rows[5][h]);
    [[unroll]] for (uint v = 0; v < 4; v++) made[4 * v + h] = activate(kActivation, winogradResult(m, v) + bias);
  }
  const Place place = placeOf(quad);
  if (kHasResidual)
    [[unroll]] for (uint i = 0; i < 16; i++) {
      const uint pixel = pixelAt(4 * column + i % 4, rowOf(row, i / 4)) + pixelsTo(place);
      made[i] += texelFetch(residual, int(pixel * p.residual.stride + p.residual.offset + place.quad));
    }
  return made;
}

void main() {
  const uint targetStart = p.target.offset - p.storeOrigin;
#ifdef XRDS_LANE
  const uint last = p.squares * p.quads - 1;
  const uint chunk = gl_WorkGroupID.x * gl_WorkGroupSize.y + gl_LocalInvocationID.y;
  const SquareQuad own = squareQuad(min(chunk * kLanes + gl_LocalInvocationID.x, last), p.quads);
  const vec4 made[16] = pixels(own.square, gl_WorkGroupID.y, own.quad);
  const uint first = (uniformOf(gl_WorkGroupID.x, 4) * gl_WorkGroupSize.y + uniformOf(gl_LocalInvocationID.y, 2)) * kLanes;
  const uint row = uniformOf(gl_WorkGroupID.y, 4), side = kPooled ? 2 : 4;
  uint laneStart[kLanes];
  [[unroll]] for (uint l = 0; l < kLanes; l++) {
    const SquareQuad item = squareQuad(min(first + l, last), p.quads);
    const Place place = placeOf(item.quad);
    laneStart[l] = (side * item.square * p.shuffle + pixelsTo(place)) * p.target.stride + targetStart + place.quad;
  }
  if (kPooled) {
    [[unroll]] for (int v = 1; v >= 0; v--)
      [[unroll]] for (uint h = 0; h < 2; h++) {
        const WIDE4 wide = wide4(pooledPixel(made, h, v));
        const uint start = pooledAt(h, rowOf(row, 2 * v)) * p.target.stride;
        [[unroll]] for (uint l = 0; l < kLanes; l++) storeLane(start + laneStart[l], wide, l);
      }
    return;
  }
  [[unroll]] for (int v = 3; v >= 0; v--)
    [[unroll]] for (uint h = 0; h < 4; h++) {
      const WIDE4 wide = wide4(made[4 * v + h]);
      const uint start = pixelAt(h, rowOf(row, v)) * p.target.stride;
      [[unroll]] for (uint l = 0; l < kLanes; l++) storeLane(start + laneStart[l], wide, l);
    }
#else
  const uint quad = gl_WorkGroupID.x * gl_WorkGroupSize.y + gl_LocalInvocationID.y;
  const uint column = gl_WorkGroupID.y * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (column >= p.squares || quad >= p.quads) return;
  const vec4 made[16] = pixels(column, gl_WorkGroupID.z, quad);
  const Place place = placeOf(quad);
  if (kPooled) {
    for (uint i = 0; i < 4; i++) {
      const uint y = p.rowBegin + 4 * gl_WorkGroupID.z + i / 2 * 2;
      if (y < p.rowEnd)
        target[pooledAt(2 * column + i % 2, y) * p.target.stride + targetStart + quad] =
            stored4(pooledPixel(made, i % 2, i / 2));
    }
    return;
  }
  for (uint i = 0; i < 16; i++) {
    const uint y = p.rowBegin + 4 * gl_WorkGroupID.z + i / 4;
    if (y < p.rowEnd)
      target[(pixelAt(4 * column + i % 4, y) + pixelsTo(place)) * p.target.stride + targetStart + place.quad] = stored4(made[i]);
  }
#endif
}
