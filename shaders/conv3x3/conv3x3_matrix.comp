// y = activation(x * w + b) + residual as in conv3x3.comp, for matrix units: x and w are halves, sums are fp32.
// A workgroup computes 16 x 8 pixels of 16 * kOutputFragments outputs; sixteen pixels side by side are the rows of a
// fragment, which a tap reads from the pixels in shared memory where it finds them, so nothing is copied for the product.
// A step has 16 input channels, with the weights of three taps at a time. Weights as in conv3x3.comp.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#define LEFT_TEXELS ((kMatrixRows + 2) * kConv3x3MatrixStride * kLeftStride)
#define RIGHT_TEXELS (3 * 8 * kConv3x3MatrixTexels * kRightStride)
#define kLeftStride (kConv3x3MatrixTexels + 1)  // of a pixel; padded, so that neighbours lie in different banks
#define kRightStride (2 * kOutputFragments + 1)
#include "shaders/common/matrix_tile.glsl"
#include "shaders/common/activation.glsl"
#include "shaders/common/storage.glsl"
#include "shaders/conv3x3/conv3x3.h"
layout(constant_id = 4) const uint kActivation = kActivationNone;
layout(constant_id = 5) const bool kHasResidual = false;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2) uniform samplerBuffer residual;
layout(binding = 3, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { Conv3x3Params p; };
const uint kStep = 8 * kConv3x3MatrixTexels, kRowTexels = 2 * kOutputFragments;  // input channels; texels of outputs

// The channel quad of the convolution's input at a pixel, zero outside and behind the last.
vec4 inputAt(ivec2 pixel, uint quad) {
  const uint sourceQuads = p.inputChannels / 4, part = quad / sourceQuads;
  const bool inside = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(p.width, p.height))) &&
                      quad < sourceQuads * p.unshuffle * p.unshuffle;
  const uvec2 from = (inside ? uvec2(pixel) * p.unshuffle + uvec2(part % 2, part / 2) : uvec2(0, p.rowBegin));
  const uint texel = (from.y * p.width * p.unshuffle + from.x) * p.source.stride + p.source.offset;
  const vec4 v = texelFetch(source, int(texel + quad % sourceQuads));
  return inside ? v : vec4(0);
}

void stagePixels(uvec2 corner, uint firstQuad) {
  const uint texels = (kMatrixRows + 2) * kConv3x3MatrixStride * kConv3x3MatrixTexels;
  for (uint at = gl_LocalInvocationIndex; at < texels; at += kInvocations) {
    const uint pixel = at / kConv3x3MatrixTexels, texel = at % kConv3x3MatrixTexels, quad = firstQuad + 2 * texel;
    const ivec2 position = ivec2(corner) + ivec2(pixel % kConv3x3MatrixStride, pixel / kConv3x3MatrixStride) - 1;
    left[pixel * kLeftStride + texel] = halves(inputAt(position, quad), inputAt(position, quad + 1));
  }
}

// Of the taps (ky, 0..2), from that input and output quad on.
void stageWeights(uint ky, uint firstInput, uint firstQuad) {
  const uint inputs = p.inputChannels * p.unshuffle * p.unshuffle, quads = p.outputChannels * p.shuffle * p.shuffle / 4;
  for (uint at = gl_LocalInvocationIndex; at < 3 * kStep * kRowTexels; at += kInvocations) {
    const uint row = at / kRowTexels, texel = at % kRowTexels, quad = firstQuad + 2 * texel;
    const uint from = ((3 * ky + row / kStep) * inputs + min(firstInput + row % kStep, inputs - 1)) * quads;
    right[row * kRightStride + texel] = halves(texelFetch(weights, int(from + min(quad, quads - 1))),
                                               texelFetch(weights, int(from + min(quad + 1, quads - 1))));
  }
}

void finish(uvec2 position, uint quad, vec4 sum) {
  const uint inputs = p.inputChannels * p.unshuffle * p.unshuffle, quads = p.outputChannels * p.shuffle * p.shuffle / 4;
  if (position.x >= p.width || position.y >= p.rowEnd || quad >= quads) return;
  const uint targetQuads = p.outputChannels / 4, part = quad / targetQuads, targetQuad = quad % targetQuads;
  const uvec2 to = position * p.shuffle + uvec2(part % 2, part / 2);
  const uint pixel = to.y * p.width * p.shuffle + to.x;
  vec4 y = activate(kActivation, sum + texelFetch(weights, int(9 * inputs * quads + quad)));
  if (kHasResidual) y += texelFetch(residual, int(pixel * p.residual.stride + p.residual.offset + targetQuad));
  target[pixel * p.target.stride + p.target.offset + targetQuad - p.storeOrigin] = stored4(y);
}

void main() {
  const uint firstQuad = gl_WorkGroupID.x * 4 * kOutputFragments, inputs = p.inputChannels * p.unshuffle * p.unshuffle;
  const uvec2 corner = uvec2(gl_WorkGroupID.y * 16, p.rowBegin + gl_WorkGroupID.z * kMatrixRows);
  const uint row = firstRow(subgroupIndex()), column = firstColumn(subgroupIndex());
  SUMS(sum, kFragmentRows, kFragmentColumns);
  [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
    [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) CLEAR_SUM(sum[r][c]);

  for (uint first = 0; first < inputs; first += kStep)
    for (uint ky = 0; ky < 3; ky++) {
      barrier();
      if (ky == 0) stagePixels(corner, first / 4);
      stageWeights(ky, first, firstQuad);
      barrier();
      [[unroll]] for (uint kx = 0; kx < 3; kx++)
        [[unroll]] for (uint k = 0; k < kConv3x3MatrixTexels; k += 2) {  // 16 inputs
          LEFT_FRAGMENTS(x, kFragmentRows);
          [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
            LOAD_LEFT(x[r], left, ((row + r + ky) * kConv3x3MatrixStride + kx) * kLeftStride + k, kLeftStride);
          [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) {
            RIGHT_FRAGMENT(w);
            LOAD_RIGHT(w, right, (kx * kStep + 8 * k) * kRightStride + 2 * (column + c), kRightStride);
            [[unroll]] for (uint r = 0; r < kFragmentRows; r++) MULTIPLY_ADD(x[r], w, sum[r][c]);
          }
        }
    }

  [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
    [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) {
      barrier();
      STORE_SUM(sum[r][c], stored, subgroupIndex() * 64, 4);
      barrier();
      for (uint i = gl_LocalInvocationIndex; i < kSubgroups * 64; i += kInvocations)
        finish(corner + uvec2(i % 64 / 4, firstRow(i / 64) + r), firstQuad + 4 * (firstColumn(i / 64) + c) + i % 4,
               storedQuad(i));
    }
}
