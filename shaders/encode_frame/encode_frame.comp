// out[y, x] = (curve(e in[y, x]), clamp(albedo, 0, 1), clamp(normal, -1, 1) / 2 + 1/2), e for radiance alone; 0 outside of
// the image and in channels behind. in: [h, w, 4], guides: [h, w, 4 or 8], out: [>= h, >= w, 4, 8 or 12] slices. One pixel
// an invocation, fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/frame_curve.glsl"
#include "shaders/encode_frame/encode_frame.h"
layout(constant_id = 0) const uint kCurve = 0;
layout(constant_id = 1) const int kGuides = 0;  // images: albedo, normal
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer guides;
layout(binding = 2) uniform samplerBuffer exposure;
#define PARAMS EncodeFrameParams
#define TARGET_BINDING 3
#define RUN 1
#define LANE_ID 2
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const ivec2 size = ivec2(p.source.width, p.source.height), inside = replicated(at, size);
  const bool outside = inside != at;
  vec3 image = texelFetch(source, texelAt(p.source, inside)).rgb, albedo = vec3(0), normal = vec3(0);
  if (kCurve == kFrameHdr) image *= texelFetch(exposure, p.exposure).x;
  image = outside ? vec3(0) : curved(kCurve, image);
  if (kGuides > 0) albedo = outside ? vec3(0) : clamp(withoutNan(fetchThree(guides, texelAt(p.guides, inside), 0)), 0.0, 1.0);
  if (kGuides > 1) normal = outside ? vec3(0) : curved(kFrameNormal, fetchThree(guides, texelAt(p.guides, inside), 3));
  storePixel(0, 0, vec4(image, albedo.x));
  if (kGuides > 0) storePixel(0, 1, vec4(albedo.yz, normal.xy));
  if (kGuides > 1) storePixel(0, 2, vec4(normal.z, 0, 0, 0));
}
