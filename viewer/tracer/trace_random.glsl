// Random numbers: a PCG stream for each pixel and sample.
#ifndef XRDS_TRACE_RANDOM_GLSL
#define XRDS_TRACE_RANDOM_GLSL

uint randomState;

uint pcg(uint value) {
  const uint state = value * 747796405u + 2891336453u;
  const uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
  return (word >> 22) ^ word;
}

void startRandom(uint pixel, uint index, uint seed) { randomState = pcg(pixel + pcg(index + pcg(seed))); }

// Uniform in [0, 1).
float random() {
  randomState = randomState * 747796405u + 2891336453u;
  const uint word = ((randomState >> ((randomState >> 28) + 4u)) ^ randomState) * 277803737u;
  return float(((word >> 22) ^ word) >> 8) * (1.0 / 16777216.0);
}

vec2 random2() {
  const float first = random();
  return vec2(first, random());
}

#endif
