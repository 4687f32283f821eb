// y = activation(x * w + b) + residual as in conv3x3.comp, for GPUs.
// A workgroup computes kPixels * kStrips by kRows pixels of 4 * kColumns outputs, an invocation (column, row, strip) four
// outputs of kPixels side by side. One input quad a step lies in shared memory: the pixels with their border, and the weights
// of all taps. The next step's texels are on their way to registers while this one is multiplied. Weights as in
// conv3x3.comp. Any subgroup size; every output is summed in the same order wherever it lies. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/activation.glsl"
#include "shaders/common/storage.glsl"
#include "shaders/conv3x3/conv3x3.h"
layout(local_size_x_id = 0, local_size_y_id = 1, local_size_z_id = 2) in;
layout(constant_id = 3) const uint kActivation = kActivationNone;
layout(constant_id = 4) const bool kHasResidual = false;
layout(constant_id = 5) const uint kPixels = 8;
// Sizes of arrays have constants of their own: Metal's cannot come from gl_WorkGroupSize before SPIRV-Cross of August 2025.
layout(constant_id = 6) const uint kColumns = 1;  // of the workgroup, as are the next two
layout(constant_id = 7) const uint kRows = 1;
layout(constant_id = 8) const uint kStrips = 1;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2) uniform samplerBuffer residual;
layout(binding = 3, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { Conv3x3Params p; };

const uint kInvocations = kColumns * kRows * kStrips;
const uint kWidth = kPixels * kStrips, kStride = kWidth + 2;  // of the pixels, without and with the border
const uint kPixelTexels = kStride * (kRows + 2), kWeightTexels = 36 * kColumns;
const uint kPixelFetches = (kPixelTexels + kInvocations - 1) / kInvocations;
const uint kWeightFetches = (kWeightTexels + kInvocations - 1) / kInvocations;
shared vec4 x[kPixelTexels];   // [row][column]
shared vec4 w[kWeightTexels];  // [tap][input of four][output quad]

void main() {
  const uint outputQuads = p.outputChannels * p.shuffle * p.shuffle / 4, lastQuad = outputQuads - 1;
  const uint sourceQuads = p.inputChannels / 4, inputQuads = sourceQuads * p.unshuffle * p.unshuffle;
  const uint column = gl_LocalInvocationID.x, row = gl_LocalInvocationID.y;
  const uint firstQuad = gl_WorkGroupID.x * kColumns, quad = firstQuad + column;
  const uvec2 corner = uvec2(gl_WorkGroupID.y * kWidth, p.rowBegin + gl_WorkGroupID.z * kRows);
  const uint stripBegin = gl_LocalInvocationID.z * kPixels;  // in the tile

  uint from[kPixelFetches];  // first texels of the pixels that this invocation fetches
  bool inside[kPixelFetches];
  [[unroll]] for (uint i = 0; i < kPixelFetches; i++) {
    const uint at = i * kInvocations + gl_LocalInvocationIndex;
    const ivec2 pixel = ivec2(corner + uvec2(at % kStride, at / kStride)) - 1;
    const uvec2 nearest = clamp(pixel, ivec2(0), ivec2(p.seenWidth, p.height) - 1) * p.unshuffle;
    inside[i] = pixel.x >= 0 && pixel.y >= 0 && pixel.x < p.seenWidth && pixel.y < p.height;
    from[i] = (nearest.y * p.width * p.unshuffle + nearest.x) * p.source.stride + p.source.offset;
  }

  vec4 nextX[kPixelFetches], nextW[kWeightFetches], sum[kPixels];
  const vec4 bias = texelFetch(weights, int(9 * 4 * inputQuads * outputQuads + min(quad, lastQuad)));
  [[unroll]] for (uint i = 0; i < kPixels; i++) sum[i] = bias;

  for (uint step = 0; step <= inputQuads; step++) {
    if (step > 0) {  // what was fetched in the round before
      barrier();
      [[unroll]] for (uint i = 0; i < kPixelFetches; i++) {
        const uint at = i * kInvocations + gl_LocalInvocationIndex;
        if (at < kPixelTexels) x[at] = nextX[i];
      }
      [[unroll]] for (uint i = 0; i < kWeightFetches; i++) {
        const uint at = i * kInvocations + gl_LocalInvocationIndex;
        if (at < kWeightTexels) w[at] = nextW[i];
      }
      barrier();
    }
    if (step < inputQuads) {
      const uint part = step / sourceQuads;  // of an unshuffled input, the pixel of four
      const uint shift = (part / 2 * p.width * p.unshuffle + part % 2) * p.source.stride + step % sourceQuads;
      [[unroll]] for (uint i = 0; i < kPixelFetches; i++) {
        const vec4 texel = texelFetch(source, int(from[i] + shift));
        nextX[i] = inside[i] ? texel : vec4(0);
      }
      [[unroll]] for (uint i = 0; i < kWeightFetches; i++) {
        const uint at = min(i * kInvocations + gl_LocalInvocationIndex, kWeightTexels - 1), row_ = at / kColumns;
        const uint channel = row_ / 4 * 4 * inputQuads + 4 * step + row_ % 4;  // [tap][K]
        nextW[i] = texelFetch(weights, int(channel * outputQuads + min(firstQuad + at % kColumns, lastQuad)));
      }
    }
    if (step > 0) {
      [[unroll]] for (uint ky = 0; ky < 3; ky++) {
        vec4 line[kPixels + 2];
        [[unroll]] for (uint i = 0; i < kPixels + 2; i++)
          line[i] = x[(row + ky) * kStride + stripBegin + i];
        [[unroll]] for (uint kx = 0; kx < 3; kx++) {
          [[unroll]] for (uint c = 0; c < 4; c++) {
            const vec4 ofChannel = w[((ky * 3 + kx) * 4 + c) * kColumns + column];
            [[unroll]] for (uint i = 0; i < kPixels; i++) sum[i] += ofChannel * line[i + kx][c];
          }
        }
      }
    }
  }

  const uvec2 first = corner + uvec2(stripBegin, row);
  if (quad > lastQuad || first.y >= p.rowEnd) return;
  const uint targetQuads = p.outputChannels / 4, part = quad / targetQuads, targetQuad = quad % targetQuads;
  [[unroll]] for (uint i = 0; i < kPixels; i++) {
    if (first.x + i >= p.width) break;
    const uvec2 to = (first + uvec2(i, 0)) * p.shuffle + uvec2(part % 2, part / 2);
    const uint pixel = to.y * p.width * p.shuffle + to.x;
    vec4 y = activate(kActivation, sum[i]);
    if (kHasResidual) y += texelFetch(residual, int(pixel * p.residual.stride + p.residual.offset + targetQuad));
    target[pixel * p.target.stride + p.target.offset + targetQuad - p.storeOrigin] = stored4(y);
  }
}
