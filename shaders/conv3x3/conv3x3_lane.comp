// y = activation(x * w + b) + residual as in conv3x3.comp, for CPU devices.
// A lane computes kRows rows of kPixels pixels (lanes behind the last repeat it) by Winograd's F(kPixels, 3) along x.
// kTile outputs a workgroup (gl_WorkGroupID.x). The loop runs over channel quads of the input. Weights of a step,
// [kElements][3 ky][4][kTile] after the transform, are spread over the lanes and handed to all of them by a shuffle with a
// constant lane; padded to whole subgroups; bias[kTile] last. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/activation.glsl"
#include "shaders/conv3x3/conv3x3.h"
layout(local_size_x_id = 0, local_size_y_id = 5) in;  // x = subgroup size; y: subgroups side by side
#define PARAMS Conv3x3Params
#define TARGET_BINDING 3
#include "shaders/common/uniform_store.glsl"
#include "shaders/common/lane_weights.glsl"
layout(constant_id = 1) const uint kRows = 4;
layout(constant_id = 2) const uint kTile = 4;
layout(constant_id = 3) const uint kActivation = kActivationNone;
layout(constant_id = 4) const bool kHasResidual = false;
#include "shaders/conv3x3/winograd.glsl"
const uint kTileQuads = kTile / 4;
const uint kRegisters = (3 * kElements * kTile + kLanes - 1) / kLanes;  // texels of weights that a lane holds
// Outputs side by side whose sums, of all rows, stay in registers: of 8 lanes (AVX2) 16, of which two hold weight and
// product.
const uint kPieces = kLanes <= 8 && kRows > 2 ? 2 : 1, kPiece = 4 / kPieces;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2) uniform samplerBuffer residual;

vec4 finished(vec4 sum, uint pixel, uint quad) {
  vec4 y = activate(kActivation, sum);
  if (kHasResidual) y += texelFetch(residual, int(pixel * p.residual.stride + p.residual.offset + quad));
  return y;
}

void main() {
  const uint columnOfLanes = gl_WorkGroupID.y * gl_WorkGroupSize.y + gl_LocalInvocationID.y;
  const uint column = min(kPixels * (columnOfLanes * kLanes + gl_LocalInvocationID.x), p.width - kPixels);
  const uint row = p.rowBegin + gl_WorkGroupID.z * kRows;
  const uint steps = p.inputChannels / 4 * p.unshuffle * p.unshuffle;
  const uint firstWeight = gl_WorkGroupID.x * (steps * kRegisters * kLanes + kTileQuads);

  int rowTexel[kRows + 2], columnTexel[kElements];
  bool hasRow[kRows + 2], hasColumn[kElements];
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

  vec4 product[kRows][kTileQuads][kElements];
  [[unroll]] for (uint i = 0; i < kRows; i++)
    [[unroll]] for (uint n = 0; n < kTileQuads; n++)
      [[unroll]] for (uint e = 0; e < kElements; e++) product[i][n][e] = vec4(0);
  uint inputQuad = 0, inputPart = 0;
  [[dont_unroll]] for (uint step = 0; step < steps; step++) {
#ifdef XRDS_ADDRESSED
    Weights w = weightsFrom(firstWeight + step * kRegisters * kLanes);
#else
    vec4 w[kRegisters];
    [[unroll]] for (uint j = 0; j < kRegisters; j++)
      w[j] = texelFetch(weights, int(firstWeight + (step * kRegisters + j) * kLanes + gl_LocalInvocationID.x));
#endif
    const int shift = int((inputPart / 2 * p.width * p.unshuffle + inputPart % 2) * p.source.stride + inputQuad);
    vec4 x[kRows + 2][kElements];
    [[unroll]] for (uint i = 0; i < kRows + 2; i++) {
      vec4 d[kElements];
      [[unroll]] for (uint j = 0; j < kElements; j++) {
        const vec4 v = texelFetch(source, rowTexel[i] + columnTexel[j] + shift);
        d[j] = hasRow[i] && hasColumn[j] ? v : vec4(0);
      }
      x[i] = transformed(d);
    }
    [[unroll]] for (uint n = 0; n < kTileQuads; n++)
      [[unroll]] for (uint e = 0; e < kElements; e++)
        [[unroll]] for (uint piece = 0; piece < kPieces; piece++)
          [[unroll]] for (uint ky = 0; ky < 3; ky++)
            [[unroll]] for (uint c = 0; c < 4; c++) {
              if (c % 2 == 0) endBlock(product[0][n][e], product[kRows - 1][n][e]);
              const uint texel = ((e * 3 + ky) * 4 + c) * kTileQuads + n;
              [[unroll]] for (uint o = 0; o < kPiece; o++) {
                const uint q = piece * kPiece + o;
#ifdef XRDS_ADDRESSED
                const float weight = w.texel[texel][q];
#else
                const float weight = handedOut(w[texel / kLanes][q], texel % kLanes);
#endif
                [[unroll]] for (uint i = 0; i < kRows; i++)
                  product[i][n][e][q] = plusProduct(product[i][n][e][q], x[i + ky][e][c], weight);
              }
            }
    inputQuad++;
    if (inputQuad == p.inputChannels / 4) {
      inputQuad = 0;
      inputPart++;
    }
  }

  vec4 bias[kTileQuads];
  [[unroll]] for (uint n = 0; n < kTileQuads; n++)
    bias[n] = texelFetch(weights, int(firstWeight + steps * kRegisters * kLanes + n));
  const uint targetQuads = p.outputChannels / 4, firstQuad = uniformOf(gl_WorkGroupID.x, 2) * kTileQuads;
  const uvec2 corner = uvec2(kPixels * kLanes * uniformOf(columnOfLanes, 4), p.rowBegin + uniformOf(gl_WorkGroupID.z, 4) * kRows);
  const uint targetStart = p.target.offset - p.storeOrigin;
  uint laneOffset[kLanes];  // of a lane's first pixel in the target
  [[unroll]] for (uint l = 0; l < kLanes; l++)
    laneOffset[l] = (min(corner.x + kPixels * l, p.width - kPixels) - corner.x) * p.shuffle * p.target.stride;
  [[unroll]] for (uint i = 0; i < kRows; i++)
    [[unroll]] for (uint h = 0; h < kPixels; h++)
      [[unroll]] for (uint n = 0; n < kTileQuads; n++) {
        const vec4 sum = resultOf(product[i][n], h) + bias[n];
        // Of a shuffled output, the pixel of four that the channels belong to; a division would be done lane by lane.
        const uint part = uint(firstQuad + n >= targetQuads) + uint(firstQuad + n >= 2 * targetQuads) +
                          uint(firstQuad + n >= 3 * targetQuads);
        const uint quad = firstQuad + n - part * targetQuads, targetWidth = p.width * p.shuffle;
        const uvec2 partOffset = uvec2(part % 2, part / 2);
        const uvec2 own = uvec2(column + h, row + i) * p.shuffle + partOffset;
        const WIDE4 y = wide4(finished(sum, own.y * targetWidth + own.x, quad));
        const uvec2 first = uvec2(corner.x + h, corner.y + i) * p.shuffle + partOffset;
        const uint firstTarget = (first.y * targetWidth + first.x) * p.target.stride + targetStart + quad;
        [[unroll]] for (uint l = 0; l < kLanes; l++) storeLane(firstTarget + laneOffset[l], y, l);
      }
}
