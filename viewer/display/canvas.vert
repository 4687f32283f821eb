#version 460
// One triangle over the whole viewport.
void main() {
  const vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1);
  gl_Position = vec4(4.0 * corner - 1.0, 0, 1);
}
