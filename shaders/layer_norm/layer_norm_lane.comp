// y = (x - mean(x)) / sqrt(var(x) + epsilon) * weight + bias as in layer_norm.comp, for CPU devices.
// A token a lane, held whole; weights in shared memory at constant offsets, so that a read is a broadcast operand. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/wide_storage.glsl"
#include "shaders/layer_norm/layer_norm.h"
layout(local_size_x_id = 0, local_size_y = kLayerNormLaneRows) in;  // x = subgroup size
layout(constant_id = 1) const uint kChannels = 4;
layout(constant_id = 2) const bool kWide = false;  // eight channels begin at a multiple of eight
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2, std430) writeonly buffer Target4 { WIDE4 target4[]; };
layout(binding = 2, std430) writeonly buffer Target8 { WIDE8 target8[]; };
layout(push_constant) uniform Push { LayerNormParams p; };
const uint kQuads = kChannels / 4;
shared vec4 affine[2 * kQuads];  // weight, then bias

void main() {
  for (uint i = gl_LocalInvocationIndex; i < 2 * kQuads; i += gl_WorkGroupSize.x * gl_WorkGroupSize.y)
    affine[i] = texelFetch(weights, int(i));
  barrier();

  const uint row = gl_WorkGroupID.x * gl_WorkGroupSize.y + gl_LocalInvocationID.y;
  const uint lane = p.tokenBegin + row * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  const bool exists = lane < p.tokenEnd;
  const uint token = min(lane, p.tokenEnd - 1);
  const uint from = token * p.source.stride + p.source.offset;
  vec4 x[kQuads], sum = vec4(0), squares = vec4(0);
  [[unroll]] for (uint q = 0; q < kQuads; q++) sum += x[q] = texelFetch(source, int(from + q));
  const float mean = dot(sum, vec4(1)) / float(kChannels);
  [[unroll]] for (uint q = 0; q < kQuads; q++) {
    x[q] -= mean;
    squares += x[q] * x[q];
  }
  const float scale = inversesqrt(dot(squares, vec4(1)) / float(kChannels) + p.epsilon);

  [[unroll]] for (uint q = 0; q < kQuads; q++) x[q] = x[q] * scale * affine[q] + affine[kQuads + q];
  const uint to = token * p.target.stride + p.target.offset - p.storeOrigin;
  if (exists && kWide) {
    [[unroll]] for (uint n = 0; n < kQuads / 2; n++) target8[to / 2 + n] = wide8(x[2 * n], x[2 * n + 1]);
  } else if (exists) {
    [[unroll]] for (uint q = 0; q < kQuads; q++) target4[to + q] = wide4(x[q]);
  }
}
