// picture = mean radiance of all samples so far, sums = their sum and number: [height, width, 4]. One pixel an
// invocation. Path tracing with next event estimation, weighted with the power heuristic (Veach 1997), and Russian
// roulette. A pixel whose path has ended begins its next sample while its neighbours still go on: a lane never idles.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "viewer/tracer/trace_camera.glsl"
#include "viewer/tracer/trace_light.glsl"
#include "viewer/tracer/trace_surface.glsl"

// A path on its way: what light arriving along the ray contributes, and how likely drawLight() were to find it.
struct Path {
  Ray ray;
  vec3 throughput, radiance;
  float density;  // with which the last scattering drew the ray; 0: light could not have been drawn
  int bounce;
};

Path beginPath(ivec2 at, uint index) {
  startRandom(uint(at.y * p.width + at.x), index, p.seed);
  return Path(cameraRay(at), vec3(1), vec3(0), 0.0, 0);
}

float powerHeuristic(float own, float other) { return own * own / (own * own + other * other); }

vec3 clamped(vec3 light, bool isIndirect) {
  const float mean = (light.x + light.y + light.z) / 3.0;
  return isIndirect && mean > p.indirectClamp ? light * (p.indirectClamp / mean) : light;
}

// Light that the path ran into, from the sky or from an emitting surface.
void addFound(inout Path path, vec3 emitted, float density) {
  const float weight = path.density > 0.0 ? powerHeuristic(path.density, density) : 1.0;
  path.radiance += clamped(path.throughput * emitted * weight, path.bounce > 1);
}

// Light drawn for the surface, unless it is hidden.
void addDrawn(inout Path path, Surface surface, vec3 outgoing) {
  const LightSample light = drawLight(surface.position);
  const vec4 towards = scatteringTowards(surface, outgoing, light.direction);
  const bool counts = light.density > 0.0 && towards.a > 0.0;
  const Ray shadow = Ray(offsetOrigin(surface.position, surface.geometricNormal, light.direction), light.direction);
  const bool isHidden = intersect(shadow, counts ? light.distance * 0.9999 : 0.0, true).triangle >= 0;
  const float weight = powerHeuristic(light.density, towards.a) / max(light.density, 1e-20);
  const vec3 arriving = path.throughput * towards.rgb * light.radiance * weight;
  if (counts && !isHidden) path.radiance += clamped(arriving, path.bounce > 0);
}

// Goes on by one scattering; returns whether the path has ended.
bool advance(inout Path path) {
  const Hit hit = intersect(path.ray, kFar, false);
  const vec4 fromSky = skyFrom(path.ray.direction);
  const Surface surface = surfaceAt(path.ray, hit);
  const bool isMissed = hit.triangle < 0;
  const float cosine = dot(surface.geometricNormal, path.ray.direction);
  const float found = isMissed ? fromSky.a : emitterDensity(surface.emission, hit.distance, cosine);
  addFound(path, isMissed ? fromSky.rgb : surface.emission, found);
  const bool isLast = isMissed || path.bounce >= p.maxBounces;
  const vec3 outgoing = -path.ray.direction;
  Surface lit = surface;
  if (isLast) lit.kind = kGlass;  // for which no light is drawn
  addDrawn(path, lit, outgoing);

  const Scatter next = scatter(surface, outgoing);
  path.throughput *= next.weight;
  path.density = next.density;
  path.ray = Ray(offsetOrigin(surface.position, surface.geometricNormal, next.direction), next.direction);
  path.bounce++;
  const float strongest = max(path.throughput.x, max(path.throughput.y, path.throughput.z));
  const float survival = path.bounce > 2 ? min(strongest, 0.95) : 1.0;
  const bool dies = strongest <= 0.0 || random() >= survival;
  path.throughput /= max(survival, 1e-6);
  return isLast || dies;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, p.rowBegin);
  if (at.x >= p.width || at.y >= p.rowEnd) return;
  const int place = at.y * p.width + at.x - p.storeOrigin;
  vec4 sum = sums[place];
  int left = askedSamples();
  Path path = beginPath(at, uint(sum.w));
  while (left > 0) {
    if (advance(path)) {
      sum += vec4(path.radiance, 1);
      path = beginPath(at, uint(sum.w));
      left--;
    }
  }
  sums[place] = sum;
  picture[place] = vec4(sum.rgb / max(sum.w, 1.0), 0);
}
