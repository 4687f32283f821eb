// The rays of the camera.
#ifndef XRDS_TRACE_CAMERA_GLSL
#define XRDS_TRACE_CAMERA_GLSL
#include "viewer/tracer/trace_geometry.glsl"
#include "viewer/tracer/trace_random.glsl"

// Through a point of the pixel drawn from a tent one pixel wide, about as sharp as Cycles' filter.
Ray cameraRay(ivec2 at) {
  const vec2 inPixel = 0.5 * (random2() + random2());
  const vec2 place = (vec2(at) + inPixel) / vec2(p.width, p.height) * 2.0 - 1.0;
  const vec3 right = texelFetch(view, 1).xyz, up = texelFetch(view, 2).xyz, forward = texelFetch(view, 3).xyz;
  return Ray(texelFetch(view, 0).xyz, normalize(forward + place.x * right - place.y * up));
}

// How many samples a pixel is to get.
int askedSamples() { return int(texelFetch(view, 0).w); }

#endif
