// Rays, and the walk through the bounding volume hierarchy. No stack: see bvh.h. On CPU devices a branch saves nothing,
// a loop ends with its last lane, hence the inner loop that takes every lane to its next leaf.
#ifndef XRDS_TRACE_GEOMETRY_GLSL
#define XRDS_TRACE_GEOMETRY_GLSL
#include "viewer/tracer/trace_bindings.glsl"

const float kFar = 1e30;

struct Ray {
  vec3 origin, direction;
};

struct Hit {
  float distance;  // kFar if nothing was hit
  int triangle;
  vec2 barycentric;
  vec3 across;  // the triangle's edges: first x second
};

vec3 safeInverse(vec3 v) { return 1.0 / mix(v, vec3(1e-20), lessThan(abs(v), vec3(1e-20))); }

// The nearest hit before `limit`, or with `any` the first that is found.
Hit intersect(Ray ray, float limit, bool any) {
  const vec3 inverse = safeInverse(ray.direction);
  const bvec3 isNegative = lessThan(ray.direction, vec3(0));
  const int octant = int(isNegative.x) + 2 * int(isNegative.y) + 4 * int(isNegative.z);
  const int first = octant * p.nodeCount;
  // Distances to the planes of a box are linear in the box's grid numbers. They are compared as integers, which orders
  // floats where one of them is not negative: CPU devices have no fast minimum of floats.
  const uvec3 nearShift = uvec3(mix(vec3(0), vec3(16), isNegative));
  const vec3 step = vec3(p.gridStepX, p.gridStepY, p.gridStepZ) * inverse;
  const vec3 start = (vec3(p.gridX, p.gridY, p.gridZ) - ray.origin) * inverse;
  Hit hit = Hit(limit, -1, vec2(0), vec3(0));
  int node = limit > 0.0 ? 0 : p.nodeCount;
  while (node < p.nodeCount) {
    int leaf = -1;
    while (node < p.nodeCount && leaf < 0) {
      const vec4 box = texelFetch(nodes, first + node);
      const uvec3 bounds = floatBitsToUint(box.xyz);
      const vec3 enter = vec3(ivec3(bounds >> nearShift & 0xffffu)) * step + start;
      const vec3 leave = vec3(ivec3(bounds >> (16u - nearShift) & 0xffffu)) * step + start;
      const ivec3 a = floatBitsToInt(enter), b = floatBitsToInt(leave);
      const bool isHit = max(max(a.x, a.y), max(a.z, 0)) <= min(min(b.x, b.y), min(b.z, floatBitsToInt(hit.distance)));
      const int link = int(box.w);
      leaf = isHit ? -link - 1 : -1;
      node = isHit || link < 0 ? node + 1 : link;
    }
    int triangle = leaf >> 2;
    const int last = leaf < 0 ? -2 : triangle + (leaf & 3);
    while (triangle <= last) {
      const vec3 corner = texelFetch(triangles, kCornerTexels * triangle).xyz;
      const vec3 edge1 = texelFetch(triangles, kCornerTexels * triangle + 1).xyz;
      const vec3 edge2 = texelFetch(triangles, kCornerTexels * triangle + 2).xyz;
      const vec3 across = cross(ray.direction, edge2), from = ray.origin - corner;
      const float scale = 1.0 / dot(edge1, across);
      const vec3 other = cross(from, edge1);
      const float u = dot(from, across) * scale, v = dot(ray.direction, other) * scale;
      const float distance = dot(edge2, other) * scale;
      if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0 && distance < hit.distance)
        hit = Hit(distance, triangle, vec2(u, v), cross(edge1, edge2));
      triangle++;
    }
    if (any && hit.triangle >= 0) node = p.nodeCount;
  }
  if (hit.triangle < 0) hit.distance = kFar;
  return hit;
}

// Where a ray to `direction` starts that leaves the surface at `position`.
vec3 offsetOrigin(vec3 position, vec3 geometricNormal, vec3 direction) {
  const vec3 size = abs(position);
  const float offset = p.originOffset + 1e-5 * max(size.x, max(size.y, size.z));
  return position + geometricNormal * (dot(direction, geometricNormal) >= 0.0 ? offset : -offset);
}

#endif
