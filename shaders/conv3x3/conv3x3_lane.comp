// y = activation(x * w + b) + residual as in conv3x3.comp, for CPU devices.
// kTile outputs a workgroup (gl_WorkGroupID.x). The loop runs over channel quads of the input. Weights of a step,
// [kElements][3 ky][4][kTile] after the transform, are spread over the lanes and handed to all of them by a shuffle with a
// constant lane; padded to whole subgroups; bias[kTile] last. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/conv3x3/conv3x3_lane.glsl"
#include "shaders/common/lane_weights.glsl"
const uint kRegisters = (3 * kElements * kTile + kLanes - 1) / kLanes;  // texels of weights that a lane holds
// Outputs side by side whose sums, of all rows, stay in registers: of 8 lanes (AVX2) 16, of which two hold weight and
// product.
const uint kPieces = kLanes <= 8 && kRows > 2 ? 2 : 1, kPiece = 4 / kPieces;

void main() {
  const uint across = gl_WorkGroupID.y * gl_WorkGroupSize.y + gl_LocalInvocationID.y, down = gl_WorkGroupID.z;
  findInputs(across, down);
  const uint steps = p.inputChannels / 4 * p.unshuffle * p.unshuffle;
  const uint firstWeight = gl_WorkGroupID.x * (steps * kRegisters * kLanes + kTileQuads);

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
    [[unroll]] for (uint i = 0; i < kRows + 2; i++) x[i] = elementsOf(i, shift);
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
  findTarget(across, down);
  findLanes();
  [[unroll]] for (uint i = 0; i < kRows; i++)
    [[unroll]] for (uint h = 0; h < kPixels; h++)
      [[unroll]] for (uint n = 0; n < kTileQuads; n++) store(resultOf(product[i][n], h) + bias[n], i, h, n);
}
