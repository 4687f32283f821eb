// y = activation(x * w + b) + residual as in conv3x3_lane.comp, of the same weights, where those of a tile fit in shared
// memory: there a weight is an operand of the multiplication, and need not be handed out.
// First all channels of the inputs are transformed. Then all subgroups of the workgroup make the products of one element
// and four outputs before the next, so that their code is read from the instruction cache. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/conv3x3/conv3x3_lane.glsl"
layout(constant_id = 6) const uint kQuads = 1;  // of the source's channels
const uint kQuadTexels = (3 * kElements * kTile + kLanes - 1) / kLanes * kLanes;  // of weights
const uint kTexels = kQuads * kQuadTexels + kTileQuads;
shared vec4 tile[kTexels];

void main() {
  STAGE_WEIGHTS(tile, weights, gl_WorkGroupID.x * kTexels, kTexels);
  // Subgroups of a workgroup lie side by side, then below each other. No constants: each would be a program of its own.
  const uint columns = (p.width + kPixels * kLanes - 1) / (kPixels * kLanes);
  const uint sideBySide = columns / gl_NumWorkGroups.y, rows = gl_WorkGroupSize.y / sideBySide;
  const uint across = kept(gl_WorkGroupID.y * sideBySide + gl_LocalInvocationID.y % sideBySide);
  const uint down = kept(gl_WorkGroupID.z * rows + gl_LocalInvocationID.y / sideBySide);
  findInputs(across, down);
  vec4 x[kQuads][kRows + 2][kElements];
  [[unroll]] for (uint i = 0; i < kRows + 2; i++)
    [[unroll]] for (uint k = 0; k < kQuads; k++) {
      x[k][i] = elementsOf(i, int(k));
      [[unroll]] for (uint e = 0; e < kElements; e++) x[k][i][e] = kept(x[k][i][e]);
    }

  findTarget(across, down);
  [[unroll]] for (uint n = 0; n < kTileQuads; n++) {
    vec4 product[kRows][kElements];
    [[unroll]] for (uint e = 0; e < kElements; e++) {
      waitForTurn();
      [[unroll]] for (uint i = 0; i < kRows; i++) product[i][e] = vec4(0);
      [[unroll]] for (uint k = 0; k < kQuads; k++)
        [[unroll]] for (uint ky = 0; ky < 3; ky++)
          [[unroll]] for (uint c = 0; c < 4; c++) {
            const vec4 weight = tile[k * kQuadTexels + ((e * 3 + ky) * 4 + c) * kTileQuads + n];
            [[unroll]] for (uint i = 0; i < kRows; i++)
              product[i][e] = plusProduct(product[i][e], x[k][i + ky][e][c], weight);
          }
      [[unroll]] for (uint i = 0; i < kRows; i++) product[i][e] = kept(product[i][e]);
    }
    waitForTurn();
    findLanes();
    const vec4 bias = tile[kQuads * kQuadTexels + n];
    [[unroll]] for (uint i = 0; i < kRows; i++)
      [[unroll]] for (uint h = 0; h < kPixels; h++) store(resultOf(product[i], h) + bias, i, h, n);
  }
}
