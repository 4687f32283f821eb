#version 460
#extension GL_GOOGLE_include_directive : require
// Draws a picture straight from the buffer in which the network left it. What it shows is fixed for a pipeline, because
// a CPU runs both sides of every branch.
// display = curve(exposure * mean of the pixels under the fragment)
#include "viewer/display/picture_parameters.h"
#include "viewer/display/srgb.glsl"

layout(constant_id = 0) const uint kKind = 0;
layout(set = 0, binding = 0) uniform samplerBuffer texels;
layout(set = 0, binding = 1) uniform samplerBuffer otherTexels;  // the reference of an error; what became of windows
layout(set = 0, binding = 2) uniform samplerBuffer heatTexels;
layout(push_constant) uniform Block { PictureParameters parameters; };
layout(location = 0) out vec4 colour;

vec3 pixelOf(uvec2 at) {
  const Picture picture = parameters.picture;
  const uint plane = kKind == kKindNormal ? 1 : 0;
  return texelFetch(texels, int((at.y * picture.planes + plane) * picture.width + at.x)).xyz;
}

vec3 heat(float value, float leastLog10, float mostLog10) {
  const float share = (log(max(value, 1e-12)) / log(10.0) - leastLog10) / (mostLog10 - leastLog10);
  return texelFetch(heatTexels, int(clamp(share, 0.0, 1.0) * 255.0 + 0.5)).rgb;
}

vec3 errorOf(vec3 found, uvec2 at) {
  const vec3 expected = texelFetch(otherTexels, int(at.y * parameters.width + at.x)).rgb;
  float error = 0.0;
  for (int c = 0; c < 3; ++c) error += relativeSquaredError(found[c], expected[c]) / 3.0;
  return heat(error, kLeastErrorLog10, kMostErrorLog10);
}

// Windows that were not computed: darker, and tinted in the colour that the map has for them.
vec3 dimmed(vec3 value, uvec2 at) {
  const uint columns = (parameters.width + parameters.windowSide - 1) / parameters.windowSide;
  const uvec2 window = at / parameters.windowSide;
  const vec4 tint = texelFetch(otherTexels, int(window.y * columns + window.x));
  return tint.a * value + tint.rgb / max(parameters.exposure, 1e-6);
}

vec3 valueAt(vec2 position) {
  const Picture picture = parameters.picture;
  const vec2 ratio = vec2(picture.width, picture.height) / vec2(parameters.width, parameters.height);
  const uvec2 at = min(uvec2(max(position * ratio, 0.0)), uvec2(picture.width, picture.height) - 1);
  const vec3 value = pixelOf(at);
  if (kKind == kKindError) return errorOf(value, at);
  if (kKind == kKindFlicker) return heat(value.x, kLeastFlickerLog10, kMostFlickerLog10);
  return kKind == kKindSkip ? dimmed(value, at) : value;
}

// Rational fit of a film curve (Narkowicz 2015), scaled so that middle grey keeps its place.
vec3 filmic(vec3 linear) {
  const vec3 x = max(linear, 0.0) * 0.8;
  return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

vec3 shown(vec3 value) {
  if (kKind == kKindNormal) return clamp(0.5 * value + 0.5, 0.0, 1.0);
  if (kKind == kKindAlbedo || kKind == kKindError || kKind == kKindFlicker) return srgb(value);
  const vec3 exposed = parameters.exposure * value;
  return srgb(parameters.curve == kCurveFilmic ? filmic(exposed) : exposed);
}

void main() {
  const vec2 position = (gl_FragCoord.xy - vec2(parameters.originX, parameters.originY)) / parameters.zoom;
  // Seen from afar a fragment covers many pixels: a few of them, evenly spread, stand for all.
  const int taps = clamp(int(ceil(1.0 / parameters.zoom)), 1, 4);
  vec3 sum = vec3(0);
  for (int y = 0; y < taps; ++y)
    for (int x = 0; x < taps; ++x) {
      const vec2 offset = (vec2(x, y) + 0.5) / float(taps) - 0.5;
      sum += valueAt(position + offset / parameters.zoom);
    }
  colour = vec4(shown(sum / float(taps * taps)), 1);
}
