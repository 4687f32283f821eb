// target[i] = the fixed point of a -> a * scale + offset: eight chains of multiply-adds an invocation, in registers
// alone. p.loops * kSteps steps each.
#version 450
#extension GL_EXT_control_flow_attributes : require
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kSteps = 64;
layout(binding = 0) uniform samplerBuffer source;  // scale, offset, start
layout(binding = 1, std430) writeonly buffer Target { vec4 target[]; };
layout(push_constant) uniform Push { uint loops; } p;

void main() {
  const vec4 scale = texelFetch(source, 0), offset = texelFetch(source, 1), start = texelFetch(source, 2);
  vec4 a = start, b = 2.0 * start;  // more chains would not stay in the registers of a CPU's loop
  for (uint i = 0; i < p.loops; i++) {
    [[unroll]] for (uint j = 0; j < kSteps; j++) {
      a = a * scale + offset;
      b = b * scale + offset;
    }
  }
  target[gl_GlobalInvocationID.x] = 0.5 * (a + b);
}
