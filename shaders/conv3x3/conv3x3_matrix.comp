// y = activation(x * w + b) + residual as in conv3x3.comp, for matrix units: x and w are halves, sums are fp32.
// A workgroup computes 16 x 8 pixels of 16 * kOutputFragments outputs; sixteen pixels side by side are the rows of a
// fragment, which a tap reads from the pixels in shared memory where it finds them, so nothing is copied for the product.
// A step has 16 input channels, in stages of kTaps taps: what the next stage needs is on its way to registers while this
// one is multiplied. Weights: [step][tap][N][16], whole tiles of a workgroup's outputs, zero behind the last; bias[N].
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
layout(constant_id = 10) const uint kTaps = 3;             // of a stage: 3, a row of them, or all 9
layout(constant_id = 11) const bool kWholeSteps = false;   // of input channels
layout(constant_id = 12) const bool kUnshuffles = false;
#define PIXELS ((kMatrixRows + 2) * kConv3x3MatrixStride)
#define LEFT_TEXELS (PIXELS * kStride)
#define RIGHT_TEXELS (kTaps * 16 * kOutputFragments * kStride)
#define kStride (kConv3x3MatrixTexels + 1)  // of a pixel and of an output; padded, so that neighbours lie in different banks
#include "shaders/common/matrix_tile.glsl"
#include "shaders/common/activation.glsl"
#include "shaders/common/storage.glsl"
#include "shaders/conv3x3/conv3x3.h"
layout(constant_id = 4) const uint kActivation = kActivationNone;
layout(constant_id = 5) const bool kHasResidual = false;
layout(binding = 0) uniform usamplerBuffer source;  // texels of four halves
layout(binding = 1, std430) readonly buffer Weights { uvec4 weights[]; };
layout(binding = 2) uniform samplerBuffer residual;
layout(binding = 3, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { Conv3x3Params p; };
const uint kOutputs = 16 * kOutputFragments, kStep = 8 * kConv3x3MatrixTexels, kStages = 9 / kTaps;  // of a step
const uint kPixelTexels = PIXELS * kConv3x3MatrixTexels, kWeightTexels = kTaps * kOutputs * kConv3x3MatrixTexels;
const uint kPixelFetches = (kPixelTexels + kInvocations - 1) / kInvocations;
const uint kWeightFetches = (kWeightTexels + kInvocations - 1) / kInvocations;
const uint kLines = kInvocations / kConv3x3MatrixTexels;  // pixels or outputs that are fetched at once

uint inputs() { return kUnshuffles ? 4 * p.inputChannels : p.inputChannels; }
uint steps() { return (inputs() + kStep - 1) / kStep; }
uint outputs() { return gl_NumWorkGroups.x * kOutputs; }  // with those behind the last
uvec2 corner() { return uvec2(gl_WorkGroupID.y * 16, p.rowBegin + gl_WorkGroupID.z * kMatrixRows); }

bool isInside(ivec2 pixel) {
  return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(p.seenWidth, p.height)));
}

// The first texel of a pixel; of one outside, that of a pixel which can be read.
uint firstTexel(ivec2 pixel) {
  const uvec2 at = isInside(pixel) ? uvec2(pixel) : uvec2(0, p.rowBegin);
  const uint position = kUnshuffles ? 4 * at.y * p.width + 2 * at.x : at.y * p.width + at.x;
  return position * p.source.stride + p.source.offset;
}

// Four input channels of a pixel, whose texels begin there; zero outside.
uvec2 quadAt(uint first, bool inside, uint quad) {
  if (!kWholeSteps && quad >= inputs() / 4) {
    inside = false;
    quad = 0;
  }
  if (kUnshuffles) {
    const uint part = quad / (p.inputChannels / 4);
    first += (part / 2 * 2 * p.width + part % 2) * p.source.stride;
    quad %= p.inputChannels / 4;
  }
  const uvec2 four = texelFetch(source, int(first + quad)).xy;
  return inside ? four : uvec2(0);
}

vec4 biasOf(uint quad) {
  const uvec4 texel = weights[steps() * 9 * outputs() * kConv3x3MatrixTexels + quad / 2];
  const uvec2 four = quad % 2 == 0 ? texel.xy : texel.zw;
  return vec4(unpackHalf2x16(four.x), unpackHalf2x16(four.y));
}

bool isStored(uvec2 position, uint quad) {
  return position.x < p.width && position.y < p.rowEnd && quad < p.outputChannels * p.shuffle * p.shuffle / 4;
}

// The pixel of the result, and its quad, that four outputs of a position become.
uvec2 placeOf(uvec2 position, uint quad) {
  const uint targetQuads = p.outputChannels / 4, part = quad / targetQuads;
  const uvec2 to = position * p.shuffle + uvec2(part % 2, part / 2);
  return uvec2(to.y * p.width * p.shuffle + to.x, quad % targetQuads);
}

vec4 residualOf(uvec2 position, uint quad) {
  if (!isStored(position, quad)) return vec4(0);
  const uvec2 place = placeOf(position, quad);
  return texelFetch(residual, int(place.x * p.residual.stride + p.residual.offset + place.y));
}

void finish(uvec2 position, uint quad, vec4 sum, vec4 added) {
  if (!isStored(position, quad)) return;
  const uvec2 place = placeOf(position, quad);
  vec4 y = activate(kActivation, sum);
  if (kHasResidual) y += added;
  target[place.x * p.target.stride + p.target.offset + place.y - p.storeOrigin] = stored4(y);
}

// An invocation fetches the same texel of a step for each of its pixels and outputs.
const uint kWeightLines = kTaps * kOutputs;
uint fetchedTexel() { return gl_LocalInvocationIndex % kConv3x3MatrixTexels; }
uint lineOf(uint i) { return i * kLines + gl_LocalInvocationIndex / kConv3x3MatrixTexels; }

uint pixelFrom[kPixelFetches], weightFrom[kWeightFetches];
bool inside[kPixelFetches];
uvec4 nextX[kPixelFetches], nextW[kWeightFetches];  // of the next stage

void findTexels() {
  [[unroll]] for (uint i = 0; i < kPixelFetches; i++) {
    const uvec2 at = uvec2(lineOf(i) % kConv3x3MatrixStride, lineOf(i) / kConv3x3MatrixStride);
    const ivec2 pixel = ivec2(corner() + at) - 1;
    pixelFrom[i] = firstTexel(pixel);
    inside[i] = isInside(pixel);
  }
  [[unroll]] for (uint i = 0; i < kWeightFetches; i++) {
    const uint row = lineOf(i) / kOutputs * outputs() + gl_WorkGroupID.x * kOutputs + lineOf(i) % kOutputs;
    weightFrom[i] = row * kConv3x3MatrixTexels + fetchedTexel();
  }
}

void fetch(uint stage) {
  const uint quad = stage / kStages * kStep / 4 + 2 * fetchedTexel();
  if (stage % kStages == 0)
    [[unroll]] for (uint i = 0; i < kPixelFetches; i++)
      nextX[i] = uvec4(quadAt(pixelFrom[i], inside[i], quad), quadAt(pixelFrom[i], inside[i], quad + 1));
  const uint stageFrom = stage * kTaps * outputs() * kConv3x3MatrixTexels;
  [[unroll]] for (uint i = 0; i < kWeightFetches; i++)
    if (lineOf(i) < kWeightLines) nextW[i] = weights[weightFrom[i] + stageFrom];
}

void share(uint stage) {
  if (stage % kStages == 0)
    [[unroll]] for (uint i = 0; i < kPixelFetches; i++)
      if (lineOf(i) < PIXELS) pool[lineOf(i) * kStride + fetchedTexel()] = nextX[i];
  [[unroll]] for (uint i = 0; i < kWeightFetches; i++)
    if (lineOf(i) < kWeightLines) pool[kRightAt + lineOf(i) * kStride + fetchedTexel()] = nextW[i];
}

void main() {
  const uint row = firstRow(subgroupIndex()), column = firstColumn(subgroupIndex());
  SUMS(sum, kFragmentRows, kFragmentColumns);
  [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
    [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) CLEAR_SUM(sum[r][c]);

  findTexels();
  const uint stages = steps() * kStages;
  for (uint stage = 0; stage <= stages; stage++) {
    if (stage > 0) {  // what was fetched in the round before
      barrier();
      share(stage - 1);
      barrier();
    }
    if (stage < stages) fetch(stage);
    if (stage > 0) {
      const uint firstTap = (stage - 1) % kStages * kTaps;
      [[unroll]] for (uint t = 0; t < kTaps; t++) {
        const uint ky = firstTap / 3 + t / 3, kx = t % 3;
        LEFT_FRAGMENTS(x, kFragmentRows);
        [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
          LOAD_LEFT(x[r], pool, ((row + r + ky) * kConv3x3MatrixStride + kx) * kStride, kStride);
        [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) {
          RIGHT_FRAGMENT(w);
          LOAD_RIGHT(w, pool, kRightAt + (t * kOutputs + 16 * (column + c)) * kStride, kStride);
          [[unroll]] for (uint r = 0; r < kFragmentRows; r++) MULTIPLY_ADD(x[r], w, sum[r][c]);
        }
      }
    }
  }

  // What is added to the sums is all on its way before the first of them is stored.
#define POSITION(r, inRow) (corner() + uvec2(inRow, row + r))
#define QUAD(c, inColumn) (gl_WorkGroupID.x * kOutputs / 4 + 4 * (column + c) + inColumn)
  vec4 bias[kFragmentColumns], added[kFragmentRows][kFragmentColumns][kQuadsOfLane];
  [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) {
    bias[c] = biasOf(QUAD(c, lane() % 4));
    if (kHasResidual)
      [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
        [[unroll]] for (uint i = 0; i < kQuadsOfLane; i++)
          added[r][c][i] = residualOf(POSITION(r, (i * kLanes + lane()) / 4), QUAD(c, lane() % 4));
  }
  barrier();
  [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
    [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) {
#define FINISH(i, inRow, inColumn, value) \
  finish(POSITION(r, inRow), QUAD(c, inColumn), value + bias[c], added[r][c][i])
      EACH_QUAD(sum[r][c], FINISH);
    }
}
