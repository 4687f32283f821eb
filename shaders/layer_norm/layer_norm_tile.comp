// y = (x - mean(x)) / sqrt(var(x) + epsilon) * weight + bias as in layer_norm.comp, for GPUs.
// kShare invocations side by side hold a token, each every kShare-th of its texels, so that neighbours read and store
// neighbouring texels; their sums meet in shared memory. Any subgroup size. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/groups.h"
#include "shaders/common/storage.glsl"
#include "shaders/layer_norm/layer_norm.h"
layout(local_size_x_id = 0, local_size_y_id = 1) in;
layout(constant_id = 2) const uint kChannels = 4;
// Sizes of arrays have constants of their own: Metal's cannot come from gl_WorkGroupSize before SPIRV-Cross of August 2025.
layout(constant_id = 3) const uint kShare = 1;  // of the workgroup, as is the next
layout(constant_id = 4) const uint kTokens = 1;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { LayerNormParams p; };

const uint kQuads = kChannels / 4, kTexels = (kQuads + kShare - 1) / kShare;
shared float means[kShare * kTokens], variances[kShare * kTokens];

void main() {
  const uint share = gl_LocalInvocationID.x, firstOfToken = gl_LocalInvocationID.y * kShare;
  const uint token = p.tokenBegin + foldedGroup() * kTokens + gl_LocalInvocationID.y;
  const uint from = min(token, p.tokenEnd - 1) * p.source.stride + p.source.offset;

  vec4 x[kTexels], sum = vec4(0), squares = vec4(0);
  [[unroll]] for (uint i = 0; i < kTexels; i++) {
    const uint quad = i * kShare + share;
    const vec4 texel = texelFetch(source, int(from + min(quad, kQuads - 1)));
    x[i] = quad < kQuads ? texel : vec4(0);
    sum += x[i];
  }
  means[gl_LocalInvocationIndex] = dot(sum, vec4(1));
  barrier();
  float mean = 0;
  [[unroll]] for (uint i = 0; i < kShare; i++) mean += means[firstOfToken + i];
  mean /= float(kChannels);

  [[unroll]] for (uint i = 0; i < kTexels; i++) {
    x[i] -= mean;
    if (i * kShare + share < kQuads) squares += x[i] * x[i];
  }
  variances[gl_LocalInvocationIndex] = dot(squares, vec4(1));
  barrier();
  float variance = 0;
  [[unroll]] for (uint i = 0; i < kShare; i++) variance += variances[firstOfToken + i];
  const float scale = inversesqrt(variance / float(kChannels) + p.epsilon);

  if (token >= p.tokenEnd) return;
  const uint to = token * p.target.stride + p.target.offset - p.storeOrigin;
  [[unroll]] for (uint i = 0; i < kTexels; i++) {
    const uint quad = i * kShare + share;
    if (quad < kQuads)
      target[to + quad] =
          stored4(x[i] * scale * texelFetch(weights, int(quad)) + texelFetch(weights, int(kQuads + quad)));
  }
}
