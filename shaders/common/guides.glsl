// What a pixel looks like. The includer defines kAlbedoOffset and kNormalOffset (-1: there are no normals), and
// includes power2.glsl before.
#ifndef XRDS_SHADERS_COMMON_GUIDES_GLSL
#define XRDS_SHADERS_COMMON_GUIDES_GLSL
#include "shaders/common/guides.h"
#include "shaders/common/image.glsl"

// Scaled so that two of them compare as 2^-|difference|^2.
struct Guide {
  vec3 albedo, normal;
};

const float kScaleOfSquares = sqrt(0.5 * kLog2E);

Guide guideAt(samplerBuffer image, int texel) {
  Guide guide;
  guide.albedo = fetchThree(image, texel, kAlbedoOffset) * (kScaleOfSquares / kSigmaAlbedo);
  guide.normal = vec3(0);
  if (kNormalOffset >= 0) guide.normal = fetchThree(image, texel, kNormalOffset) * (kScaleOfSquares / kSigmaNormal);
  return guide;
}

float likeness(Guide a, Guide b) {
  const vec3 albedo = a.albedo - b.albedo;
  float square = dot(albedo, albedo);
  if (kNormalOffset >= 0) {
    const vec3 normal = a.normal - b.normal;
    square += dot(normal, normal);
  }
  return power2(-square);
}

#endif
