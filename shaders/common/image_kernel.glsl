// The frame of an image kernel: an invocation makes a run of RUN pixels of a column of the target, which begin at
// firstPixel(); storePixel() stores four channels of one of them. The kernel defines PARAMS (with `target` and `rows`),
// TARGET_BINDING, RUN (a power of two) and LANE_ID, its first free constant_id. XRDS_LANE: the version for CPU devices,
// in which a subgroup makes runs side by side, stores at uniform addresses and repeats the last column behind it.
#ifndef XRDS_SHADERS_COMMON_IMAGE_KERNEL_GLSL
#define XRDS_SHADERS_COMMON_IMAGE_KERNEL_GLSL
#include "shaders/common/image.glsl"
#ifdef XRDS_LANE
layout(local_size_x_id = LANE_ID, local_size_y = kImageLaneSubgroups) in;  // x = subgroup size
#define SMALL_DIGITS
#include "shaders/common/uniform_store.glsl"

ivec2 firstPixel() {
  const uint x = (gl_WorkGroupID.x * kImageLaneSubgroups + gl_LocalInvocationID.y) * kLanes + gl_LocalInvocationID.x;
  return ivec2(min(int(x), p.target.width - 1), p.rows.begin + RUN * int(gl_WorkGroupID.y));
}

// All rows of a run belong to the dispatch.
bool isOutside(ivec2 first) { return false; }

void storePixel(int inRun, int quad, vec4 value) {
  const uint group = uniformOf(gl_WorkGroupID.x, 3) * kImageLaneSubgroups + uniformOf(gl_LocalInvocationID.y, 1);
  const int x = int(group * kLanes), y = p.rows.begin + RUN * int(uniformOf(gl_WorkGroupID.y, 4)) + inRun;
  const WIDE4 wide = wide4(value);
  [[unroll]] for (uint l = 0; l < kLanes; l++) {
    const ivec2 at = ivec2(min(x + int(l), p.target.width - 1), y);
    storeLane(uint(texelAt(p.target, at) + quad - p.rows.storeOrigin), wide, l);
  }
}
#else
#include "shaders/common/storage.glsl"
layout(local_size_x = kImageGroupWidth, local_size_y = kImageGroupHeight) in;
layout(binding = TARGET_BINDING, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { PARAMS p; };

void waitForTurn() {}

ivec2 firstPixel() {
  return ivec2(gl_GlobalInvocationID.x, (p.rows.begin / RUN + int(gl_GlobalInvocationID.y)) * RUN);
}

bool isOutside(ivec2 first) { return first.x >= p.target.width || first.y >= p.rows.end; }

void storePixel(int inRun, int quad, vec4 value) {
  const ivec2 at = firstPixel() + ivec2(0, inRun);
  if (at.y >= p.rows.begin && at.y < p.rows.end)
    target[texelAt(p.target, at) + quad - p.rows.storeOrigin] = stored4(value);
}
#endif

#endif
