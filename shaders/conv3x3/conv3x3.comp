// y = activation(x * w + b) + residual, 3x3, zero padding; input unshuffled and output shuffled by 2 on demand.
// x, residual, y: NHWC slices; weights: [ky][kx][K][N], then bias[N], a shuffled channel as (dy, dx, c). An invocation
// computes four channels of four pixels side by side; neighbours share the pixels and read consecutive weights. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/common/activation.glsl"
#include "shaders/common/groups.h"
#include "shaders/common/storage.glsl"
#include "shaders/conv3x3/conv3x3.h"
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kActivation = kActivationNone;
layout(constant_id = 1) const bool kHasResidual = false;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2) uniform samplerBuffer residual;
layout(binding = 3, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { Conv3x3Params p; };

// The channel quad of the convolution's input at a pixel, zero outside.
vec4 inputAt(ivec2 pixel, uint quad) {
  const uint sourceQuads = p.inputChannels / 4, part = quad / sourceQuads;
  const uvec2 inside = clamp(pixel, ivec2(0), ivec2(p.seenWidth, p.height) - 1);
  const uvec2 from = inside * p.unshuffle + uvec2(part % 2, part / 2);
  const uint texel = (from.y * p.width * p.unshuffle + from.x) * p.source.stride + p.source.offset;
  const vec4 v = texelFetch(source, int(texel + quad % sourceQuads));
  return uvec2(pixel) == inside ? v : vec4(0);
}

void main() {
  const uint outputQuads = p.outputChannels * p.shuffle * p.shuffle / 4;
  const uint inputQuads = p.inputChannels * p.unshuffle * p.unshuffle / 4;
  const uint item = foldedGroup() * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  const uint quad = item % outputQuads, strip = item / outputQuads;
  const uint stripsInRow = (p.width + kConv3x3Pixels - 1) / kConv3x3Pixels;
  const uvec2 first = uvec2(strip % stripsInRow * kConv3x3Pixels, p.rowBegin + strip / stripsInRow);
  if (first.y >= p.rowEnd) return;

  vec4 sum[kConv3x3Pixels];
  for (uint i = 0; i < kConv3x3Pixels; i++) sum[i] = texelFetch(weights, int(9 * 4 * inputQuads * outputQuads + quad));
  for (uint ky = 0; ky < 3; ky++)
    for (uint k = 0; k < inputQuads; k++) {
      vec4 x[kConv3x3Pixels + 2];
      for (uint i = 0; i < kConv3x3Pixels + 2; i++) x[i] = inputAt(ivec2(first) + ivec2(i, ky) - 1, k);
      for (uint kx = 0; kx < 3; kx++) {
        mat4 columns;  // column c: the weights of input channel 4 k + c
        for (uint c = 0; c < 4; c++)
          columns[c] = texelFetch(weights, int(((ky * 3 + kx) * 4 * inputQuads + 4 * k + c) * outputQuads + quad));
        for (uint i = 0; i < kConv3x3Pixels; i++) sum[i] += columns * x[i + kx];
      }
    }

  const uint targetQuads = p.outputChannels / 4, part = quad / targetQuads;
  for (uint i = 0; i < kConv3x3Pixels && first.x + i < p.width; i++) {
    const uvec2 to = (first + uvec2(i, 0)) * p.shuffle + uvec2(part % 2, part / 2);
    const uint pixel = to.y * p.width * p.shuffle + to.x;
    vec4 y = activate(kActivation, sum[i]);
    if (kHasResidual) y += texelFetch(residual, int(pixel * p.residual.stride + p.residual.offset + quad % targetQuads));
    target[pixel * p.target.stride + p.target.offset + quad % targetQuads - p.storeOrigin] = stored4(y);
  }
}
