// y[c] = x[c] gate[c] + addend[c], without a gate x[c] + addend[c]. x, addend, y: [h, w, c] slices, gate: [1, 1, c]. One
// pixel an invocation, a vec4 at a time, fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/gated_sum/gated_sum.h"
layout(constant_id = 0) const int kChannels = 4;
layout(constant_id = 1) const bool kHasGate = true;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 2) uniform samplerBuffer addend;
layout(binding = 3) uniform samplerBuffer gate;
#define PARAMS GatedSumParams
#define TARGET_BINDING 1
#define RUN 1
#define LANE_ID 2
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const int from = texelAt(p.source, at), beside = texelAt(p.addend, at);
  [[unroll]] for (int q = 0; q < kChannels / 4; q++) {
    vec4 x = texelFetch(source, from + q);
    if (kHasGate) x *= texelFetch(gate, int(p.gateOffset) + q);
    storePixel(0, q, x + texelFetch(addend, beside + q));
  }
}
