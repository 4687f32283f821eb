// target[i] = start after p.loops * kSteps steps of twelve numbers a, b, ..: a * scale + b in place of a, b * scale + c of b,
// and so on around. Of scale = -2 and numbers that are all 1 each step changes the sign. As each chain needs its
// neighbour, a compiler cannot compute one after the other, waiting for each sum, as it does of chains that stand alone.
// Twelve are in flight, which hides the waiting, and with scale and a product fit the 16 registers of AVX2.
// XRDS_APART: chains that do stand alone, a * scale + 3, for compilers that keep them side by side.
#version 450
#extension GL_EXT_control_flow_attributes : require
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kSteps = 64;  // even
layout(binding = 0) uniform samplerBuffer source;  // scale, then start three times
layout(binding = 1, std430) writeonly buffer Target { vec4 target[]; };
layout(push_constant) uniform Push { uint loops; } p;

void main() {
  const float scale = texelFetch(source, 0).x;
#ifdef XRDS_APART
  const float offset = 1.0 - scale;
#endif
  vec4 a = texelFetch(source, 1), b = texelFetch(source, 2), c = texelFetch(source, 3);
  for (uint i = 0; i < p.loops; i++) {
    [[unroll]] for (uint j = 0; j < kSteps; j++) {
#ifdef XRDS_APART
      a = a * scale + offset;
      b = b * scale + offset;
      c = c * scale + offset;
#else
      const float first = a.x;
      a = a * scale + vec4(a.yzw, b.x);
      b = b * scale + vec4(b.yzw, c.x);
      c = c * scale + vec4(c.yzw, first);
#endif
    }
  }
  target[gl_GlobalInvocationID.x] = (a + b + c) / 3.0;
}
