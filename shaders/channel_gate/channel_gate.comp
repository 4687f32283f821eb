// out = sigmoid(W_U relu(W_D z + b_D) + b_U), z[c] = sum over y of in[y, c] / h. in: [h, 1, c], out: [1, 1, c] slices.
// Weights: W_D [few][c], b_D [few, to fours], W_U [few][c], b_U [c]. One workgroup: four channels an invocation at a time,
// then a squeezed channel each, then four channels again. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/channel_gate/channel_gate.h"
#include "shaders/common/storage.glsl"
layout(local_size_x = kChannelGateGroup) in;
layout(constant_id = 0) const uint kChannels = 4;
layout(constant_id = 1) const uint kFew = 1;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { ChannelGateParams p; };
const uint kQuads = kChannels / 4;
const uint kDownBias = kFew * kQuads, kUp = kDownBias + (kFew + 3) / 4, kUpBias = kUp + kFew * kQuads;
shared vec4 means[kQuads];
shared float hidden[kFew];

// The lanes leave each loop together: lavapipe of Mesa 26.1 crashes where texels are fetched in one that they leave one by one.
void main() {
  for (uint first = 0; first < kQuads; first += kChannelGateGroup) {
    const uint quad = first + gl_LocalInvocationID.x;
    if (quad >= kQuads) continue;
    vec4 sum = vec4(0);
    for (uint y = 0; y < p.height; y++) sum += texelFetch(source, int(y * p.source.stride + p.source.offset + quad));
    means[quad] = sum / float(p.height);
  }
  barrier();
  for (uint first = 0; first < kFew; first += kChannelGateGroup) {
    const uint j = first + gl_LocalInvocationID.x;
    if (j >= kFew) continue;
    float sum = texelFetch(weights, int(kDownBias + j / 4))[j % 4];
    for (uint quad = 0; quad < kQuads; quad++) sum += dot(texelFetch(weights, int(j * kQuads + quad)), means[quad]);
    hidden[j] = max(sum, 0.0);
  }
  barrier();
  for (uint first = 0; first < kQuads; first += kChannelGateGroup) {
    const uint quad = first + gl_LocalInvocationID.x;
    if (quad >= kQuads) continue;
    vec4 sum = texelFetch(weights, int(kUpBias + quad));
    for (uint j = 0; j < kFew; j++) sum += hidden[j] * texelFetch(weights, int(kUp + j * kQuads + quad));
    target[p.target.offset + quad] = stored4(1.0 / (1.0 + exp(-sum)));
  }
}
