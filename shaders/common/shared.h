// Included by GLSL and C++: lets one header hold a parameter struct for both.
#ifndef XRDS_SHADERS_COMMON_SHARED_H
#define XRDS_SHADERS_COMMON_SHARED_H

#ifdef __cplusplus
#include "engine/dispatch.h"
#define XRDS_SHARED_BEGIN  \
  namespace xrds::shader { \
  using uint = uint32_t;
#define XRDS_SHARED_END }
#else
#define XRDS_SHARED_BEGIN
#define XRDS_SHARED_END
#endif

XRDS_SHARED_BEGIN
/// A TensorView's channels in units of vec4: pixel p, channel quad q is texel p * stride + offset + q, modulo 2^32: of
/// a band of rows the offset is negative.
struct Slice {
  uint offset, stride;
};
XRDS_SHARED_END

#ifdef __cplusplus
namespace xrds {
inline shader::Slice sliceOf(const TensorView& view) { return {view.firstTexel(), view.channelStride / 4}; }
}  // namespace xrds
#endif
#endif
