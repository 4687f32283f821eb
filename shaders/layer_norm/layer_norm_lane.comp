// y = (x - mean(x)) / sqrt(var(x) + epsilon) * weight + bias as in layer_norm.comp, for CPU devices.
// A token a lane, held whole; weights in shared memory at constant offsets, so that a read is a broadcast operand. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/layer_norm/layer_norm.h"
layout(local_size_x_id = 0, local_size_y_id = 2) in;  // x = subgroup size
#define PARAMS LayerNormParams
#define TARGET_BINDING 2
#include "shaders/common/uniform_store.glsl"
layout(constant_id = 1) const uint kChannels = 4;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
const uint kQuads = kChannels / 4;
shared vec4 affine[2 * kQuads];  // weight, then bias

void main() {
  STAGE_WEIGHTS(affine, weights, 0, 2 * kQuads);

  const uint row = gl_WorkGroupID.x * gl_WorkGroupSize.y + gl_LocalInvocationID.y;
  const uint token = min(p.tokenBegin + row * kLanes + gl_LocalInvocationID.x, p.tokenEnd - 1);
  const uint firstToken = p.tokenBegin + uniformOf(row, 6) * kLanes;
  const uint from = token * p.source.stride + p.source.offset;
  vec4 x[kQuads], sum = vec4(0), squares = vec4(0);
  [[unroll]] for (uint q = 0; q < kQuads; q++) sum += x[q] = texelFetch(source, int(from + q));
  const float mean = dot(sum, vec4(1)) / float(kChannels);
  [[unroll]] for (uint q = 0; q < kQuads; q++) {
    x[q] -= mean;
    squares += x[q] * x[q];
  }
  const float scale = inversesqrt(dot(squares, vec4(1)) / float(kChannels) + p.epsilon);

  const uint firstTarget = firstToken * p.target.stride + p.target.offset - p.storeOrigin;
  [[unroll]] for (uint q = 0; q < kQuads; q++) {
    const WIDE4 y = wide4(x[q] * scale * affine[q] + affine[kQuads + q]);
    [[unroll]] for (uint l = 0; l < kLanes; l++)
      storeLane(firstTarget + q + (min(firstToken + l, p.tokenEnd - 1) - firstToken) * p.target.stride, y, l);
  }
}
