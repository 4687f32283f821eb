// target[i] = 2 source[i] + kAdd for the first p.count quads. One quad an invocation.
#version 450
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kAdd = 0;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1, std430) writeonly buffer Target { vec4 target[]; };
layout(push_constant) uniform Push { uint count; } p;

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < p.count) target[i] = 2.0 * texelFetch(source, int(i)) + float(kAdd);
}
