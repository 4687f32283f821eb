#version 460
#extension GL_GOOGLE_include_directive : require
// Draws two pictures, one on either side of the divider, straight from the buffers in which the network left them.
// display = curve(exposure * mean of the pixels under the fragment)
#include "viewer/picture_parameters.h"

layout(set = 0, binding = 0) uniform samplerBuffer leftTexels;
layout(set = 0, binding = 1) uniform samplerBuffer rightTexels;
layout(set = 0, binding = 2) uniform samplerBuffer referenceTexels;
layout(set = 0, binding = 3) uniform samplerBuffer heatTexels;
layout(push_constant) uniform Block { PictureParameters parameters; };
layout(location = 0) out vec4 colour;

const vec3 kBackground = vec3(0.11);

vec3 channels(Picture picture, vec4 first, vec4 second) {
  switch (picture.channel & 3) {
    case 0: return first.xyz;
    case 1: return first.yzw;
    case 2: return vec3(first.zw, second.x);
    default: return vec3(first.w, second.xy);
  }
}

vec3 pixelOf(bool onLeft, Picture picture, uvec2 at) {
  const int texel = int(((at.y * picture.width + at.x) * picture.stride + picture.channel) / 4);
  const int next = (picture.channel & 3) > 1 ? texel + 1 : texel;
  if (onLeft) return channels(picture, texelFetch(leftTexels, texel), texelFetch(leftTexels, next));
  return channels(picture, texelFetch(rightTexels, texel), texelFetch(rightTexels, next));
}

vec3 heat(vec3 found, uvec2 at) {
  const vec3 expected = texelFetch(referenceTexels, int(at.y * parameters.width + at.x)).rgb;
  const vec3 difference = found - expected;
  const float error = dot(difference * difference / (expected * expected + 0.01), vec3(1.0 / 3.0));
  const float decades = parameters.mostErrorLog10 - parameters.leastErrorLog10;
  const float share = (log(max(error, 1e-12)) / log(10.0) - parameters.leastErrorLog10) / decades;
  return texelFetch(heatTexels, int(clamp(share, 0.0, 1.0) * 255.0 + 0.5)).rgb;
}

vec3 valueAt(bool onLeft, Picture picture, vec2 position) {
  const vec2 ratio = vec2(picture.width, picture.height) / vec2(parameters.width, parameters.height);
  const uvec2 at = min(uvec2(max(position * ratio, 0.0)), uvec2(picture.width, picture.height) - 1);
  const vec3 value = pixelOf(onLeft, picture, at);
  return picture.kind == kKindError ? heat(value, at) : value;
}

vec3 srgb(vec3 linear) {
  const vec3 c = clamp(linear, 0.0, 1.0);
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}

// Rational fit of a film curve (Narkowicz 2015), scaled so that middle grey keeps its place.
vec3 filmic(vec3 linear) {
  const vec3 x = max(linear, 0.0) * 0.8;
  return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

vec3 shown(Picture picture, vec3 value) {
  if (picture.kind == kKindNormal) return clamp(0.5 * value + 0.5, 0.0, 1.0);
  if (picture.kind != kKindRadiance) return srgb(value);
  const vec3 exposed = parameters.exposure * value;
  return srgb(parameters.curve == kCurveFilmic ? filmic(exposed) : exposed);
}

void main() {
  const vec2 position = (gl_FragCoord.xy - vec2(parameters.originX, parameters.originY)) / parameters.zoom;
  const bool outside = any(lessThan(position, vec2(0))) ||
                       any(greaterThanEqual(position, vec2(parameters.width, parameters.height)));
  colour = vec4(kBackground, 1);
  if (outside) return;
  const bool onLeft = gl_FragCoord.x < parameters.divider;
  Picture picture = parameters.right;
  if (onLeft) picture = parameters.left;
  // Seen from afar a fragment covers many pixels: a few of them, evenly spread, stand for all.
  const int taps = clamp(int(ceil(1.0 / parameters.zoom)), 1, 4);
  vec3 sum = vec3(0);
  for (int y = 0; y < taps; ++y)
    for (int x = 0; x < taps; ++x) {
      const vec2 offset = (vec2(x, y) + 0.5) / float(taps) - 0.5;
      sum += valueAt(onLeft, picture, position + offset / parameters.zoom);
    }
  colour.rgb = shown(picture, sum / float(taps * taps));
}
