// The window and head of a workgroup of the tile and the matrix kernel: where tokens are, which see each other, biases. Included
// after the table, the parameters, kWindow and kQuads, the texels of a token's head.
#ifndef XRDS_SHADERS_WINDOW_ATTENTION_WINDOW_GLSL
#define XRDS_SHADERS_WINDOW_ATTENTION_WINDOW_GLSL
const uint kRelative = 2 * kWindow - 1;
const float kHidden = -2e30, kLowest = -1e30;  // what is hidden never is the highest
const float kLog2E = 1.4426950408889634;         // scores are powers of two
shared float biases[(kRelative * kRelative + 3) / 4 * 4];  // what lies behind begins at a whole vec4

uvec2 inWindow(uint token) { return uvec2(token % kWindow, token / kWindow); }

// The window's corner in the shifted image.
uvec2 corner() {
  return kWindow * uvec2(gl_WorkGroupID.x, (p.firstWindowRow + gl_WorkGroupID.y) % (p.height / kWindow));
}

// A bias of the query for key 0, and by how much that of another key lies before it.
uint firstBias(uvec2 query) { return (query.y + kWindow - 1) * kRelative + query.x + kWindow - 1; }
uint biasesBehind(uvec2 key) { return key.y * kRelative + key.x; }

// Which of the bands that the shift keeps apart a position of the shifted image lies in, as one number.
uint regionOf(uvec2 position) {
  const uvec2 size = uvec2(p.width, p.height);
  const uvec2 band = uvec2(greaterThanEqual(position, size - kWindow)) + uvec2(greaterThanEqual(position, size - p.shift));
  return band.y * 3 + band.x;
}

uint pixelOf(uvec2 position) {
  const uvec2 unshifted = (position + p.shift) % uvec2(p.width, p.height);
  return unshifted.y * p.width + unshifted.x;
}

// First texel of the pixel's channels of this head.
int texelOf(Slice slice, uint pixel) { return int(pixel * slice.stride + slice.offset + gl_WorkGroupID.z * kQuads); }

void stageBiases() {
  for (uint i = gl_LocalInvocationIndex; i < kRelative * kRelative; i += gl_WorkGroupSize.x) {
    const uint entry = i * p.headCount + gl_WorkGroupID.z;
    biases[i] = texelFetch(table, int(entry / 4))[entry % 4] * kLog2E;
  }
}

#endif
