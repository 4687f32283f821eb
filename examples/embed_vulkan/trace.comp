// Path-traces a small scene of triangles under a sky into `target`, three floats a pixel. what: 0 radiance of `samples`
// paths, 1 albedo, 2 normal of the surface that the pixel's centre sees.
#version 450
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, std430) writeonly buffer Target { float target[]; };
layout(push_constant) uniform Push { uint width, height, samples, seed, what; };

const vec3 kSun = vec3(0.48, 0.64, -0.6);
// Floor, wall behind, and a pyramid on the floor.
const int kTriangles = 8;
const vec3 kCorners[3 * kTriangles] = vec3[](
    vec3(-6, 0, -4), vec3(6, 0, -4), vec3(6, 0, 6), vec3(-6, 0, -4), vec3(6, 0, 6), vec3(-6, 0, 6),
    vec3(-6, 0, 6), vec3(6, 0, 6), vec3(6, 6, 6), vec3(-6, 0, 6), vec3(6, 6, 6), vec3(-6, 6, 6),
    vec3(-1.2, 0, 0.4), vec3(1.2, 0, 0.4), vec3(0, 2.2, 1.6), vec3(1.2, 0, 0.4), vec3(1.2, 0, 2.8), vec3(0, 2.2, 1.6),
    vec3(1.2, 0, 2.8), vec3(-1.2, 0, 2.8), vec3(0, 2.2, 1.6), vec3(-1.2, 0, 2.8), vec3(-1.2, 0, 0.4), vec3(0, 2.2, 1.6));

struct Hit {
  float distance;  // negative: the sky
  vec3 normal, albedo;
};

uint state;
float random() {
  state = state * 747796405u + 2891336453u;
  const uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
  return float(((word >> 22) ^ word) >> 8) * 5.9604645e-8;
}

Hit hitOf(vec3 from, vec3 to) {
  Hit hit = Hit(-1, vec3(0), vec3(0));
  for (int i = 0; i < kTriangles; i++) {
    const vec3 a = kCorners[3 * i], u = kCorners[3 * i + 1] - a, v = kCorners[3 * i + 2] - a;
    const vec3 p = cross(to, v), s = from - a, q = cross(s, u);
    const float determinant = dot(u, p);
    if (abs(determinant) < 1e-6) continue;
    const float x = dot(s, p) / determinant, y = dot(to, q) / determinant, distance = dot(v, q) / determinant;
    if (x < 0 || y < 0 || x + y > 1 || distance < 1e-3 || (hit.distance > 0 && distance > hit.distance)) continue;
    hit.distance = distance;
    hit.normal = normalize(cross(u, v));
    if (dot(hit.normal, to) > 0) hit.normal = -hit.normal;
    const vec3 at = from + distance * to;
    const bool isDark = (int(floor(at.x)) + int(floor(at.z))) % 2 == 0;
    hit.albedo = i < 2 ? vec3(isDark ? 0.2 : 0.7) : i < 4 ? vec3(0.7, 0.6, 0.5) : vec3(0.8, 0.25, 0.15);
  }
  return hit;
}

vec3 sky(vec3 to) { return mix(vec3(0.9), vec3(0.4, 0.6, 1.0), max(to.y, 0.0)); }

vec3 towards(vec3 normal) {  // by the cosine
  const float angle = 6.2831853 * random(), height = 2 * random() - 1, radius = sqrt(max(1 - height * height, 0.0));
  return normalize(normal * 1.0001 + vec3(radius * cos(angle), height, radius * sin(angle)));
}

vec3 radiance(vec3 from, vec3 to) {
  vec3 sum = vec3(0), weight = vec3(1);
  for (int bounce = 0; bounce < 4; bounce++) {
    const Hit hit = hitOf(from, to);
    if (hit.distance < 0) return sum + weight * sky(to);
    from += hit.distance * to;
    weight *= hit.albedo;
    const float cosine = dot(hit.normal, kSun);
    if (cosine > 0 && hitOf(from, kSun).distance < 0) sum += weight * cosine * vec3(2.0, 1.8, 1.5);
    to = towards(hit.normal);
  }
  return sum;
}

void main() {
  const uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= width || at.y >= height) return;
  const uint pixel = at.y * width + at.x;
  state = (pixel * 1973u + seed) * 9277u + 26699u;
  vec3 value = vec3(0);
  const vec3 eye = vec3(0.6, 1.7, -5);
  for (uint i = 0; i < (what == 0u ? samples : 1u); i++) {
    const vec2 inPixel = what == 0u ? vec2(random(), random()) : vec2(0.5);
    const vec2 screen = (2 * (vec2(at) + inPixel) - vec2(width, height)) / float(height);
    const vec3 to = normalize(vec3(0.6 * screen.x, -0.6 * screen.y - 0.1, 1));
    if (what == 0u) {
      value += radiance(eye, to) / float(samples);
    } else {
      const Hit hit = hitOf(eye, to);
      value = what == 1u ? hit.albedo : hit.normal;
    }
  }
  for (uint c = 0u; c < 3u; c++) target[3u * pixel + c] = value[c];
}
