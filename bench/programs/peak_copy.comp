// target[i] = source[i]. XRDS_WIDE: two vec4 an invocation, stored as 64-bit words, which CPU devices prefer.
#version 450
#extension GL_GOOGLE_include_directive : require
#ifdef XRDS_WIDE
#include "shaders/common/wide_storage.glsl"
#endif
layout(local_size_x = 64) in;
layout(binding = 0) uniform samplerBuffer source;
#ifdef XRDS_WIDE
layout(binding = 1, std430) writeonly buffer Target { WIDE8 target[]; };
#else
layout(binding = 1, std430) writeonly buffer Target { vec4 target[]; };
#endif

void main() {
  const int i = int(gl_GlobalInvocationID.x);
#ifdef XRDS_WIDE
  target[i] = wide8(texelFetch(source, 2 * i), texelFetch(source, 2 * i + 1));
#else
  target[i] = texelFetch(source, i);
#endif
}
