// What the tracer's kernels and the host share: push constants, and how the scene's buffers are laid out in texels.
#ifndef XRDS_VIEWER_TRACER_TRACE_PARAMETERS_H
#define XRDS_VIEWER_TRACER_TRACE_PARAMETERS_H
#ifdef __cplusplus
#include <cstdint>
#define XRDS_TRACE_BEGIN  \
  namespace xrds::trace { \
  using uint = uint32_t;
#define XRDS_TRACE_END }
#else
#define XRDS_TRACE_BEGIN
#define XRDS_TRACE_END
#endif

XRDS_TRACE_BEGIN
struct TraceParams {
  int width, height, rowBegin, rowEnd;  // of the picture that the kernel writes
  int storeOrigin;                      // vec4 of the picture at which the bindings of sums and picture begin
  int nodeCount, triangleCount, skySize, emitterCount;
  float gridX, gridY, gridZ;              // where number 0 of the boxes' grid lies
  float gridStepX, gridStepY, gridStepZ;  // from a number to the next
  float skyShare;                         // how often the sky, not a triangle, is drawn as the light
  float inversePower;                     // 1 / sum over emitting triangles of area * luminance
  float originOffset;                     // by which a ray leaves its surface near the origin
  float indirectClamp;
  int maxBounces;
  uint seed;
};

// A node is one texel: three words with the lower bound of the box on a grid in the low half and the upper in the high
// half, made so that each is a normal float; and the link: the node behind this one's children, or for a leaf
// - 1 - (4 * first triangle + number of triangles - 1). Its number on the grid is one of kGridBegin .. kGridEnd.
const int kGridBegin = 128, kGridEnd = 32639;

// Texels per entry. Triangle: corner and edges of all triangles, then normals (w: u) of all and v, v, v, material.
const int kCornerTexels = 3, kShadingTexels = 4, kMaterialTexels = 3, kViewTexels = 4;
const int kEnergySize = 16;  // cosines and roughnesses in the table of a metal's directional albedo
const int kTraceGroupWidth = 8, kTraceGroupHeight = 8;
const int kDiffuse = 0, kMetal = 1, kGlass = 2;
XRDS_TRACE_END

#endif
