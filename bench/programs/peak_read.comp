// target[i] = the mean of kTexels texels of the source, the same ones for no other i.
#version 450
#extension GL_EXT_control_flow_attributes : require
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kTexels = 16;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1, std430) writeonly buffer Target { vec4 target[]; };

void main() {
  vec4 sum = vec4(0);
  const uint first = gl_WorkGroupID.x * kTexels * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  [[unroll]] for (uint i = 0; i < kTexels; i++) sum += texelFetch(source, int(first + i * gl_WorkGroupSize.x));
  target[gl_GlobalInvocationID.x] = sum / float(kTexels);
}
