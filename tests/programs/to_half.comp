// target[i] = source[i] rounded to half, as every f16 kernel stores it. One quad an invocation.
#version 450
#extension GL_GOOGLE_include_directive : require
#define XRDS_F16
#include "shaders/common/storage.glsl"
layout(local_size_x = 64) in;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { uint count; } p;

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < p.count) target[i] = stored4(texelFetch(source, int(i)));
}
