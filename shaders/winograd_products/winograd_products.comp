// y[e, n] = sum over k of w[e, k, n] x[e, k] for the 36 planes e of each square, see winograd.h.
// x: [squares][36][K], or of two groups of inputs [squares]([36][F], [36][K - F]), y: [squares][36][N] slices; weights:
// [36][K][N]. An invocation makes four outputs of a square.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/common/groups.h"
#include "shaders/common/storage.glsl"
#include "shaders/winograd_products/winograd_products.h"
layout(local_size_x = 64) in;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { WinogradProductsParams p; };

// Where four inputs of a plane are.
uint quadOf(uint plane, uint k) {
  if (k < p.firstQuads) return plane * p.firstQuads + k;
  return kWinogradPlanes * p.firstQuads + plane * (p.inputQuads - p.firstQuads) + k - p.firstQuads;
}

void main() {
  const uint item = foldedGroup() * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  const uint rowQuads = kWinogradPlanes * p.outputQuads, quad = item % rowQuads;
  const uint square = p.squareBegin + item / rowQuads, plane = quad / p.outputQuads, n = quad % p.outputQuads;
  if (square >= p.squareEnd) return;
  vec4 sum = vec4(0);
  for (uint k = 0; k < p.inputQuads; k++) {
    const vec4 x = texelFetch(source, int(square * p.source.stride + p.source.offset + quadOf(plane, k)));
    mat4 columns;  // column i: the weights of input channel 4 k + i
    for (uint i = 0; i < 4; i++)
      columns[i] = texelFetch(weights, int(((plane * p.inputQuads + k) * 4 + i) * p.outputQuads + n));
    sum += columns * x;
  }
  target[square * p.target.stride + p.target.offset + quad - p.storeOrigin] = stored4(sum);
}
