// Surfaces: what a hit looks like, how it scatters light. Metals are GGX with the energy of further scatterings between
// facets added (Turquin 2019) and drawn by visible normals (Heitz 2018).
#ifndef XRDS_TRACE_SURFACE_GLSL
#define XRDS_TRACE_SURFACE_GLSL
#include "viewer/tracer/trace_geometry.glsl"
#include "viewer/tracer/trace_random.glsl"

const float kPi = 3.14159265;

struct Surface {
  vec3 position, normal, geometricNormal;  // both normals on the side of the ray
  vec3 colour, emission;
  int kind;
  float roughness, refraction;
  bool isInside;  // the ray came from behind
};

struct Scatter {
  vec3 direction, weight;  // weight: value * cosine / density
  float density;           // 0 if no light could have been drawn towards it: mirrors and glass
};

// Between the texels in the mean over random offsets, which averages over samples.
vec3 textureAt(vec3 place, vec2 uv) {
  const vec2 size = place.yz, at = fract(uv) * size + random2() - 0.5;
  const ivec2 texel = ivec2(mod(floor(at), size));
  return texelFetch(textures, int(place.x) + texel.y * int(size.x) + texel.x).rgb;
}

Surface surfaceAt(Ray ray, Hit hit) {
  const int triangle = max(hit.triangle, 0), shading = kCornerTexels * p.triangleCount + kShadingTexels * triangle;
  const vec4 a = texelFetch(triangles, shading), b = texelFetch(triangles, shading + 1);
  const vec4 c = texelFetch(triangles, shading + 2), last = texelFetch(triangles, shading + 3);
  const vec3 weights = vec3(1.0 - hit.barycentric.x - hit.barycentric.y, hit.barycentric);
  const int material = int(last.w) * kMaterialTexels;
  const vec4 colour = texelFetch(materials, material), emission = texelFetch(materials, material + 1);
  const vec4 picture = texelFetch(materials, material + 2);

  Surface surface;
  surface.position = ray.origin + hit.distance * ray.direction;
  surface.geometricNormal = normalize(hit.across);
  surface.isInside = dot(surface.geometricNormal, ray.direction) > 0.0;
  if (surface.isInside) surface.geometricNormal = -surface.geometricNormal;
  surface.normal = normalize(a.xyz * weights.x + b.xyz * weights.y + c.xyz * weights.z);
  if (dot(surface.normal, surface.geometricNormal) < 0.0) surface.normal = -surface.normal;
  if (dot(surface.normal, ray.direction) > -0.01) surface.normal = surface.geometricNormal;
  surface.colour = colour.rgb;
  surface.kind = int(colour.w);
  surface.emission = emission.rgb;
  surface.roughness = emission.w;
  surface.refraction = picture.w;
  const vec2 uv = vec2(dot(vec3(a.w, b.w, c.w), weights), dot(last.xyz, weights));
  if (picture.x >= 0.0) surface.colour *= textureAt(picture.xyz, uv);
  return surface;
}

// The rotation that takes +z to the normal (Duff et al. 2017).
mat3 frameOf(vec3 n) {
  const float s = n.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (s + n.z), b = n.x * n.y * a;
  return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

float alphaOf(float roughness) { return max(roughness * roughness, 1e-3); }

// Smith's lambda of GGX.
float shadowing(float cosine, float alpha) {
  const float square = cosine * cosine;
  return 0.5 * (sqrt(1.0 + alpha * alpha * (1.0 - square) / max(square, 1e-8)) - 1.0);
}

float facetDensity(float cosine, float alpha) {
  const float a = alpha * alpha, t = (a - 1.0) * cosine * cosine + 1.0;
  return a / (kPi * t * t);
}

vec3 fresnelOfMetal(vec3 colour, float cosine) {
  const float x = 1.0 - clamp(cosine, 0.0, 1.0), x2 = x * x;
  return colour + (1.0 - colour) * (x2 * x2 * x);
}

// What single scattering leaves of white light; each texel holds the four entries of a cell.
float directionalAlbedo(float cosine, float roughness) {
  const vec2 at = clamp(vec2(cosine, roughness), 0.0, 1.0) * float(kEnergySize - 1);
  const ivec2 cell = min(ivec2(at), ivec2(kEnergySize - 2));
  const vec4 corners = texelFetch(energy, cell.y * kEnergySize + cell.x);
  const vec2 share = at - vec2(cell), row = mix(corners.xz, corners.yw, share.x);
  return mix(row.x, row.y, share.y);
}

vec3 repeatedScattering(vec3 colour, float cosine, float roughness) {
  const float albedo = directionalAlbedo(cosine, roughness);
  return 1.0 + colour * ((1.0 - albedo) / albedo);
}

bool isSmooth(Surface surface) { return surface.kind == kGlass || surface.kind == kMetal && surface.roughness < 0.03; }

// rgb: value * cosine of light from `to` that leaves to `out`; a: the density with which scatter() draws `to`.
vec4 scatteringTowards(Surface surface, vec3 outgoing, vec3 to) {
  const float cosOut = dot(surface.normal, outgoing), cosIn = dot(surface.normal, to);
  if (cosIn <= 0.0 || dot(surface.geometricNormal, to) <= 0.0 || isSmooth(surface)) return vec4(0);
  const vec4 diffuse = vec4(surface.colour, 1.0) * (cosIn / kPi);
  const vec3 facet = normalize(outgoing + to);
  const float alpha = alphaOf(surface.roughness), inOut = shadowing(cosOut, alpha), inIn = shadowing(cosIn, alpha);
  const float spread = facetDensity(dot(surface.normal, facet), alpha) / (4.0 * cosOut);
  const vec3 reflection = fresnelOfMetal(surface.colour, dot(outgoing, facet)) *
                          repeatedScattering(surface.colour, cosOut, surface.roughness);
  const vec4 metal = spread * vec4(reflection / (1.0 + inOut + inIn), 1.0 / (1.0 + inOut));
  return surface.kind == kMetal ? metal : diffuse;
}

Scatter scatterDiffuse(Surface surface, mat3 frame, vec2 u) {
  const float radius = sqrt(u.x), angle = 2.0 * kPi * u.y;
  const float cosine = sqrt(max(1.0 - u.x, 1e-6));
  return Scatter(frame * vec3(radius * cos(angle), radius * sin(angle), cosine), surface.colour, cosine / kPi);
}

Scatter scatterMetal(Surface surface, mat3 frame, vec3 outgoing, vec2 u) {
  const float alpha = alphaOf(surface.roughness);
  const vec3 o = outgoing * frame, stretched = normalize(vec3(alpha * o.xy, o.z));
  const float across = dot(stretched.xy, stretched.xy);
  const vec3 t1 = across > 1e-12 ? vec3(-stretched.y, stretched.x, 0) * inversesqrt(across) : vec3(1, 0, 0);
  const vec3 t2 = cross(stretched, t1);
  const float radius = sqrt(u.x), angle = 2.0 * kPi * u.y, s = 0.5 * (1.0 + stretched.z);
  const float x = radius * cos(angle), y = mix(sqrt(max(1.0 - x * x, 0.0)), radius * sin(angle), s);
  const vec3 n = x * t1 + y * t2 + sqrt(max(1.0 - x * x - y * y, 0.0)) * stretched;
  const vec3 facet = isSmooth(surface) ? vec3(0, 0, 1) : normalize(vec3(alpha * n.xy, max(n.z, 1e-6)));
  const vec3 to = reflect(-o, facet);
  const float inOut = shadowing(o.z, alpha), inIn = shadowing(to.z, alpha);
  const vec3 reflection = fresnelOfMetal(surface.colour, dot(o, facet));
  if (isSmooth(surface)) return Scatter(frame * to, reflection, 0.0);
  if (to.z <= 0.0) return Scatter(frame * to, vec3(0), 1.0);
  return Scatter(
      frame * to,
      reflection * repeatedScattering(surface.colour, o.z, surface.roughness) * (1.0 + inOut) / (1.0 + inOut + inIn),
      facetDensity(facet.z, alpha) / (4.0 * o.z * (1.0 + inOut)));
}

Scatter scatterGlass(Surface surface, vec3 outgoing, float u) {
  const float eta = surface.isInside ? surface.refraction : 1.0 / surface.refraction;
  const float cosOut = clamp(dot(surface.normal, outgoing), 0.0, 1.0),
              inner = 1.0 - eta * eta * (1.0 - cosOut * cosOut);
  const float cosIn = sqrt(max(inner, 0.0));
  const float parallel = (cosOut - eta * cosIn) / (cosOut + eta * cosIn);
  const float perpendicular = (eta * cosOut - cosIn) / (eta * cosOut + cosIn);
  const float mirrored = inner <= 0.0 ? 1.0 : 0.5 * (parallel * parallel + perpendicular * perpendicular);
  const vec3 reflected = reflect(-outgoing, surface.normal);
  const vec3 refracted = (eta * cosOut - cosIn) * surface.normal - eta * outgoing;
  const bool isMirrored = u < mirrored;
  return Scatter(isMirrored ? reflected : normalize(refracted), isMirrored ? vec3(1) : surface.colour, 0.0);
}

Scatter scatter(Surface surface, vec3 outgoing) {
  const vec2 u = random2();
  const mat3 frame = frameOf(surface.normal);
  Scatter result = scatterDiffuse(surface, frame, u);
  const Scatter metal = scatterMetal(surface, frame, outgoing, u), glass = scatterGlass(surface, outgoing, u.x);
  if (surface.kind == kMetal) result = metal;
  if (surface.kind == kGlass) result = glass;
  // A smooth normal can send light through the surface.
  if (surface.kind != kGlass && dot(result.direction, surface.geometricNormal) <= 0.0) result.weight = vec3(0);
  return result;
}

#endif
