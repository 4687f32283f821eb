// Light sources: the sky and emitting triangles, as a ray meets them and as a point draws one of them.
#ifndef XRDS_TRACE_LIGHT_GLSL
#define XRDS_TRACE_LIGHT_GLSL
#include "viewer/tracer/trace_geometry.glsl"
#include "viewer/tracer/trace_random.glsl"

struct LightSample {
  vec3 direction, radiance;
  float distance, density;  // density over solid angle; 0: there is no light
};

// Places on the octahedral map, in [-1, 1].
vec2 skyPlace(vec3 d) {
  const vec3 q = d / (abs(d.x) + abs(d.y) + abs(d.z));
  const vec2 sign = vec2(q.x >= 0.0 ? 1.0 : -1.0, q.z >= 0.0 ? 1.0 : -1.0);
  return q.y >= 0.0 ? q.xz : (1.0 - abs(q.zx)) * sign;
}

vec4 skyTexel(vec2 place) {
  const ivec2 cell = clamp(ivec2(floor((0.5 * place + 0.5) * float(p.skySize))), ivec2(0), ivec2(p.skySize - 1));
  return texelFetch(sky, cell.y * p.skySize + cell.x);
}

// Between the cells in the mean over random offsets.
vec3 skyRadiance(vec2 place) { return skyTexel(place + (2.0 * random2() - 1.0) / float(p.skySize)).rgb; }

// Map area over solid angle, for a direction of unit length.
float skyStretch(vec3 d) {
  const float sum = abs(d.x) + abs(d.y) + abs(d.z);
  return 1.0 / (sum * sum * sum);
}

// rgb: radiance of the sky from there, a: the density with which drawLight() draws the direction.
vec4 skyFrom(vec3 direction) {
  const vec2 place = skyPlace(direction);
  return vec4(skyRadiance(place), p.skyShare * skyTexel(place).w * skyStretch(direction));
}

float luminance(vec3 rgb) { return dot(rgb, vec3(0.2126, 0.7152, 0.0722)); }

// The density with which drawLight() draws a point of an emitting surface that far away.
float emitterDensity(vec3 emission, float distance, float cosine) {
  return (1.0 - p.skyShare) * luminance(emission) * p.inversePower * distance * distance / max(abs(cosine), 1e-6);
}

// Walker's alias method on the table that begins at `first`.
int drawEntry(int first, int count, vec2 pick) {
  const int drawn = min(int(pick.x * float(count)), count - 1);
  const vec4 entry = texelFetch(lights, first + drawn);
  return pick.y < entry.x ? drawn : int(entry.y);
}

LightSample drawSky(vec2 pick, vec2 u) {
  const int cell = drawEntry(0, p.skySize * p.skySize, pick);
  const vec2 at = (vec2(cell % p.skySize, cell / p.skySize) + u) / float(p.skySize) * 2.0 - 1.0;
  const vec2 sign = vec2(at.x >= 0.0 ? 1.0 : -1.0, at.y >= 0.0 ? 1.0 : -1.0);
  const float height = 1.0 - abs(at.x) - abs(at.y);
  const vec2 folded = at - sign * max(-height, 0.0);
  const vec3 direction = normalize(vec3(folded.x, height, folded.y));
  return LightSample(direction, skyRadiance(at), kFar, p.skyShare * texelFetch(sky, cell).w * skyStretch(direction));
}

LightSample drawEmitter(vec3 position, vec2 pick, vec2 u) {
  const int first = p.skySize * p.skySize;
  const vec4 entry = texelFetch(lights, first + drawEntry(first, p.emitterCount, pick));
  const int triangle = int(entry.z), material = int(entry.w) * kMaterialTexels;
  const vec3 corner = texelFetch(triangles, kCornerTexels * triangle).xyz;
  const vec3 edge1 = texelFetch(triangles, kCornerTexels * triangle + 1).xyz;
  const vec3 edge2 = texelFetch(triangles, kCornerTexels * triangle + 2).xyz;
  const vec3 emission = texelFetch(materials, material + 1).rgb;
  const vec2 folded = u.x + u.y > 1.0 ? 1.0 - u : u;
  const vec3 way = corner + folded.x * edge1 + folded.y * edge2 - position;
  const float distance = length(way);
  const vec3 direction = way / max(distance, 1e-20);
  const float cosine = dot(normalize(cross(edge1, edge2)), direction);
  return LightSample(direction, emission, distance, emitterDensity(emission, distance, cosine));
}

LightSample drawLight(vec3 position) {
  const float choice = random();
  const vec2 pick = random2(), u = random2();
  const LightSample fromSky = drawSky(pick, u), fromEmitter = drawEmitter(position, pick, u);
  if (choice < p.skyShare) return fromSky;
  return fromEmitter;
}

#endif
