// What a workgroup does with its window without matrix units: where its tokens are, load and store, norms, softmax. Rows of
// `pool` are tokens or scores; several invocations, which stand side by side, share one. All call these functions together.
// Included after the buffers, the pool and its strides.
#ifndef XRDS_SHADERS_SWIN_LAYER_WINDOW_GLSL
#define XRDS_SHADERS_SWIN_LAYER_WINDOW_GLSL
shared float shares[kInvocations];

// The window's corner in the shifted image.
uvec2 corner() {
  return kSwinWindow * uvec2(gl_WorkGroupID.x, (p.firstWindowRow + gl_WorkGroupID.y) % (p.height / kSwinWindow));
}

uvec2 pixelOf(uint token) {
  return (corner() + uvec2(token % kSwinWindow, token / kSwinWindow) + p.shift) % uvec2(p.width, p.height);
}

// Windows at the end of the shifted image hold tokens that the wrap-around brought together: 1, in x; 2, in y.
uint windowClass() {
  if (!kShifted) return 0;
  const bvec2 isLast = greaterThanEqual(corner() + kSwinWindow, uvec2(p.width, p.height));
  return uint(isLast.x) + 2 * uint(isLast.y);
}

void loadTokens() {
  for (uint i = gl_LocalInvocationIndex; i < kTokens * kChannels / 8; i += kInvocations) {
    const uint token = i / (kChannels / 8), quad = i % (kChannels / 8) * 2;
    const uvec2 pixel = pixelOf(token);
    const int from = int((pixel.y * p.width + pixel.x) * p.source.stride + p.source.offset + quad);
    pool[token * kTokenStride + quad / 2] = halves(texelFetch(source, from), texelFetch(source, from + 1));
  }
}

vec4 quadOfPool(uint texel, uint h) {
  const uvec4 halves8 = pool[texel];
  return h == 0 ? vec4(unpackHalf2x16(halves8.x), unpackHalf2x16(halves8.y))
                : vec4(unpackHalf2x16(halves8.z), unpackHalf2x16(halves8.w));
}

// The sum of what the invocations of a row have.
float sumOfRow(float share, uint invocations) {
  barrier();
  shares[gl_LocalInvocationIndex] = share;
  barrier();
  float sum = 0;
  for (uint i = 0; i < invocations; i++) sum += shares[gl_LocalInvocationIndex / invocations * invocations + i];
  return sum;
}

float largestOfRow(float share, uint invocations) {
  barrier();
  shares[gl_LocalInvocationIndex] = share;
  barrier();
  float largest = share;
  for (uint i = 0; i < invocations; i++)
    largest = max(largest, shares[gl_LocalInvocationIndex / invocations * invocations + i]);
  return largest;
}

// LN without its affine map, which the maps behind it have.
void normalizeTokens() {
  const uint invocations = kInvocations / kTokens;
  const uint first = gl_LocalInvocationIndex / invocations * kTokenStride, part = gl_LocalInvocationIndex % invocations;
  vec4 sum = vec4(0);
  for (uint i = part; i < kChannels / 8; i += invocations) sum += quadOfPool(first + i, 0) + quadOfPool(first + i, 1);
  const float mean = sumOfRow(dot(sum, vec4(1)), invocations) / float(kChannels);
  vec4 squares = vec4(0);
  for (uint i = part; i < kChannels / 8; i += invocations) {
    const vec4 a = quadOfPool(first + i, 0) - mean, b = quadOfPool(first + i, 1) - mean;
    squares += a * a + b * b;
  }
  const float scale = inversesqrt(sumOfRow(dot(squares, vec4(1)), invocations) / float(kChannels) + p.epsilon);
  for (uint i = part; i < kChannels / 8; i += invocations)
    pool[first + i] =
        roundedHalves((quadOfPool(first + i, 0) - mean) * scale, (quadOfPool(first + i, 1) - mean) * scale);
}

// Scores and their biases to weights, row by row in place. The biases are halves, [query][key].
void takeSoftmax(uint biasAt) {
  const uint invocations = kInvocations / kScoreRows, quads = kTokens / 4 / invocations;
  const uint row = kScoresAt + gl_LocalInvocationIndex / invocations * kScoreStride;
  const uint part = gl_LocalInvocationIndex % invocations;
  vec4 values[quads];
  vec4 largest = vec4(-1e30);
  const uint biasRow = biasAt + gl_LocalInvocationIndex / invocations * kTokens / 8 + part * quads / 2;
  [[unroll]] for (uint i = 0; i < quads; i++) {
    const uvec4 biases = weights[biasRow + i / 2];
    const uvec2 four = i % 2 == 0 ? biases.xy : biases.zw;
    values[i] = uintBitsToFloat(pool[row + part * quads + i]) + vec4(unpackHalf2x16(four.x), unpackHalf2x16(four.y));
    largest = max(largest, values[i]);
  }
  const float top = largestOfRow(max(max(largest.x, largest.y), max(largest.z, largest.w)), invocations);
  vec4 sum = vec4(0);
  [[unroll]] for (uint i = 0; i < quads; i++) {
    values[i] = exp2(values[i] - top);
    sum += values[i];
  }
  const float scale = 1.0 / sumOfRow(dot(sum, vec4(1)), invocations);
  [[unroll]] for (uint i = 0; i < quads; i += 2)
    pool[row + (part * quads + i) / 2] = roundedHalves(values[i] * scale, values[i + 1] * scale);
}

void storeTokens() {
  for (uint i = gl_LocalInvocationIndex; i < kTokens * kOutputs / 8; i += kInvocations) {
    const uint token = i / (kOutputs / 8), texel = i % (kOutputs / 8);
    const uvec2 pixel = pixelOf(token);
    if (pixel.y < p.rowBegin || pixel.y >= p.rowEnd) continue;
    const uint to = (pixel.y * p.width + pixel.x) * p.target.stride + p.target.offset + 2 * texel - p.storeOrigin;
    const uvec4 y = pool[token * kTokenStride + texel];
    target[to] = y.xy;
    target[to + 1] = y.zw;
  }
}

#endif
