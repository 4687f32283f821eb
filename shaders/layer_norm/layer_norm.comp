// y = (x - mean(x)) / sqrt(var(x) + epsilon) * weight + bias over the channels of a token.
// x, y: [tokens][channels] slices; weights: weight[channels], bias[channels]. One token an invocation, two passes
// (mean, then squared distances: no cancellation), fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/common/groups.h"
#include "shaders/common/storage.glsl"
#include "shaders/layer_norm/layer_norm.h"
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kChannels = 4;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { LayerNormParams p; };

void main() {
  const uint token = p.tokenBegin + foldedGroup() * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (token >= p.tokenEnd) return;
  const uint quads = kChannels / 4;
  const int from = int(token * p.source.stride + p.source.offset);

  vec4 sum = vec4(0);
  for (uint q = 0; q < quads; q++) sum += texelFetch(source, from + int(q));
  const float mean = dot(sum, vec4(1)) / float(kChannels);

  vec4 squares = vec4(0);
  for (uint q = 0; q < quads; q++) {
    const vec4 distance = texelFetch(source, from + int(q)) - mean;
    squares += distance * distance;
  }
  const float scale = inversesqrt(dot(squares, vec4(1)) / float(kChannels) + p.epsilon);

  const uint to = token * p.target.stride + p.target.offset - p.storeOrigin;
  for (uint q = 0; q < quads; q++) {
    const vec4 normal = (texelFetch(source, from + int(q)) - mean) * scale;
    target[to + q] = stored4(normal * texelFetch(weights, int(q)) + texelFetch(weights, int(quads + q)));
  }
}
