// target = (e, 1 / e, 0, 0) of e = source[first], or of 1 where that is not between 1e-30 and 1e30.
#version 450
#extension GL_GOOGLE_include_directive : require
layout(constant_id = 0) const uint kFirst = 0;
layout(local_size_x = 1) in;
layout(binding = 0, std430) readonly buffer Source { float source[]; };
layout(binding = 1, std430) writeonly buffer Target { vec4 target[]; };

void main() {
  const float given = source[kFirst];
  const float exposure = given >= 1e-30 && given <= 1e30 ? given : 1.0;
  target[0] = vec4(exposure, 1.0 / exposure, 0, 0);
}
