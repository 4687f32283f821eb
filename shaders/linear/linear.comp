// y = activation(x W^T + b) + residual for each token; kNormalizes: of (x - mean(x)) / sqrt(var(x) + epsilon).
// x, of one source or two, residual, y: [tokens][channels] slices; weights: [K][N], then bias[N]. An invocation computes four outputs of
// four tokens; neighbours share the tokens and read consecutive weights. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/common/activation.glsl"
#include "shaders/common/groups.h"
#include "shaders/common/storage.glsl"
#include "shaders/linear/linear.h"
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kActivation = kActivationNone;
layout(constant_id = 1) const bool kHasResidual = false;
layout(constant_id = 2) const bool kNormalizes = false;
layout(constant_id = 3) const bool kHasAppended = false;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2) uniform samplerBuffer residual;
layout(binding = 3, std430) writeonly buffer Target { STORED4 target[]; };
layout(binding = 4) uniform samplerBuffer appended;
layout(push_constant) uniform Push { LinearParams p; };
#include "shaders/linear/token.glsl"

// Mean and one over the deviation, in two passes: no cancellation.
vec2 normOf(uint token) {
  if (!kNormalizes) return vec2(0, 1);
  const uint quads = p.inputChannels / 4;
  vec4 sum = vec4(0), squares = vec4(0);
  for (uint q = 0; q < quads; q++) sum += tokenQuad(token, q);
  const float mean = dot(sum, vec4(1)) / float(p.inputChannels);
  for (uint q = 0; q < quads; q++) {
    const vec4 distance = tokenQuad(token, q) - mean;
    squares += distance * distance;
  }
  return vec2(mean, inversesqrt(dot(squares, vec4(1)) / float(p.inputChannels) + p.epsilon));
}

void main() {
  const uint outputQuads = p.outputChannels / 4;
  const uint item = foldedGroup() * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  const uint quad = item % outputQuads;
  const uint first = p.tokenBegin + item / outputQuads * kLinearTokens;
  if (first >= p.tokenEnd) return;

  uint tokens[kLinearTokens];
  vec4 sum[kLinearTokens];
  vec2 norm[kLinearTokens];
  for (uint t = 0; t < kLinearTokens; t++) {
    tokens[t] = min(first + t, p.tokenEnd - 1);
    sum[t] = texelFetch(weights, int(p.inputChannels * outputQuads + quad));
    norm[t] = normOf(tokens[t]);
  }
  for (uint k = 0; k < p.inputChannels / 4; k++) {
    mat4 columns;  // column i: the weights of input channel 4 k + i
    for (uint i = 0; i < 4; i++) columns[i] = texelFetch(weights, int((4 * k + i) * outputQuads + quad));
    for (uint t = 0; t < kLinearTokens; t++) {
      const vec4 x = tokenQuad(tokens[t], k);
      sum[t] += columns * (kNormalizes ? (x - norm[t].x) * norm[t].y : x);
    }
  }
  for (uint t = 0; t < kLinearTokens && first + t < p.tokenEnd; t++) {
    vec4 y = activate(kActivation, sum[t]);
    if (kHasResidual) y += texelFetch(residual, int(tokens[t] * p.residual.stride + p.residual.offset + quad));
    target[tokens[t] * p.target.stride + p.target.offset + quad - p.storeOrigin] = stored4(y);
  }
}
