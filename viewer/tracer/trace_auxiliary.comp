// picture = mean (albedo, nearness) and (camera-space normal, 0) of all samples so far, sums = their sums and number:
// [height, 2, width, 4]. One pixel an invocation. The nearness is that of the first hit, 1 / its depth; 0 of the sky.
// The rule of the others is that of Cycles' denoising passes: a path goes on through glass and smooth metal, tinted, to
// the first rough surface, whose albedo and normal count; light that it meets counts as albedo.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "viewer/tracer/trace_camera.glsl"
#include "viewer/tracer/trace_light.glsl"
#include "viewer/tracer/trace_surface.glsl"

const float kLeastRoughAlpha = 0.075, kLeastDepth = 1e-6;

struct Features {
  vec3 albedo, normal;
  float nearness;
};

vec3 inCamera(vec3 direction) {
  const vec3 right = normalize(texelFetch(view, 1).xyz), up = normalize(texelFetch(view, 2).xyz);
  return vec3(dot(direction, right), dot(direction, up), dot(direction, texelFetch(view, 3).xyz));
}

Features traceFeatures(Ray ray) {
  Features features = Features(vec3(0), vec3(0), 0.0);
  vec3 throughput = vec3(1);
  int bounce = 0;
  while (bounce <= p.maxBounces) {
    const Hit hit = intersect(ray, kFar, false);
    const Surface surface = surfaceAt(ray, hit);
    const bool isMissed = hit.triangle < 0;
    if (bounce == 0 && !isMissed)
      features.nearness = 1.0 / max(hit.distance * dot(ray.direction, texelFetch(view, 3).xyz), kLeastDepth);
    features.albedo += throughput * (isMissed ? skyFrom(ray.direction).rgb : surface.emission);
    const bool isRough =
        surface.kind == kDiffuse || surface.kind == kMetal && alphaOf(surface.roughness) > kLeastRoughAlpha;
    const bool isLast = isMissed || isRough || bounce == p.maxBounces;
    if (isLast && !isMissed) {
      features.albedo += throughput * surface.colour;
      features.normal = inCamera(surface.normal);
    }
    const Scatter next = scatter(surface, -ray.direction);
    throughput *= next.weight;
    ray = Ray(offsetOrigin(surface.position, surface.geometricNormal, next.direction), next.direction);
    bounce = isLast ? p.maxBounces + 1 : bounce + 1;
  }
  return features;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, p.rowBegin);
  if (at.x >= p.width || at.y >= p.rowEnd) return;
  const int albedo = 2 * at.y * p.width + at.x - p.storeOrigin, normal = albedo + p.width;
  vec4 first = sums[albedo], second = sums[normal];
  int left = askedSamples();
  while (left > 0) {
    startRandom(uint(at.y * p.width + at.x), uint(second.w), p.seed + 1u);
    const Features features = traceFeatures(cameraRay(at));
    first += vec4(features.albedo, features.nearness);
    second += vec4(features.normal, 1);
    left--;
  }
  sums[albedo] = first;
  sums[normal] = second;
  const float scale = 1.0 / max(second.w, 1.0);
  picture[albedo] = first * scale;
  picture[normal] = vec4(second.xyz * scale, 0);
}
