// Images for the kernels of the image pipeline: one invocation a pixel, rows from a range.
#ifndef XRDS_SHADERS_COMMON_IMAGE_H
#define XRDS_SHADERS_COMMON_IMAGE_H
#include "shaders/common/shared.h"
#ifdef __cplusplus
#include "shaders/common/groups.h"
#include "shaders/common/uniform_store.h"
#endif

XRDS_SHARED_BEGIN
/// A TensorView as an image: pixel (x, y), channel quad q is texel (y * width + x) * stride + offset + q. Of a band of
/// rows the offset is negative.
struct Image {
  int offset, stride, width, height;
};

/// The rows of the target that one dispatch computes, and the vec4 index at which the target's binding starts.
struct TargetRows {
  int begin, end, storeOrigin;
};

const uint kImageGroupWidth = 32;
const uint kImageGroupHeight = 4;    // 128 invocations: any device takes as many
const uint kImageLaneSubgroups = 8;  // of a workgroup of a lane kernel, side by side
const float kLogitMax = 8.0f;        // learned logits of kernels are clamped to +- this
const float kShareLogitMax = 20.0f;  // and those of shares to +- this
XRDS_SHARED_END

#ifdef __cplusplus
namespace xrds {

inline shader::Image imageOf(const TensorView& view) {
  return {int(view.firstTexel()), int(view.channelStride / 4), int(view.width), int(view.height)};
}

inline shader::TargetRows targetRows(const TensorView& view, RowRange rows) {
  return {int(rows.begin), int(rows.end), int(storeOrigin(view, rows))};
}

/// Workgroups that cover `width` x `height` invocations.
inline std::array<uint32_t, 3> imageGroups(uint32_t width, uint32_t height) {
  return {ceilDivide(width, shader::kImageGroupWidth), ceilDivide(height, shader::kImageGroupHeight), 1};
}

/// The launch of a kernel that includes image_kernel.glsl: `run` pixels of a column an invocation, rows of the output.
template <class T>
Dispatch imageDispatch(const char* op, const DeviceTraits& device, const TensorView& output, RowRange rows,
                       uint32_t run, const T& parameters, std::vector<uint32_t> specialization,
                       std::vector<Binding> bindings) {
  Dispatch launch{.specialization = std::move(specialization), .bindings = std::move(bindings)};
  const uint32_t runs = ceilDivide(rows.end, run) - rows.begin / run;
  const bool lane = device.family == KernelFamily::lane && device.shaderInt64 && rows.begin % run == 0 &&
                    rows.end % run == 0 && runs <= kMaxGroupCount &&
                    device.subgroupSize * shader::kImageLaneSubgroups <= device.maxGroupInvocations;
  launch.program = programName(op, lane ? KernelFamily::lane : KernelFamily::plain, output.type);
  if (lane) {
    launch.specialization.push_back(device.subgroupSize);
    launch.pushConstants = pushBytesWithDigits<4>(parameters);
    launch.groupCount = {ceilDivide(output.width, device.subgroupSize * shader::kImageLaneSubgroups), runs, 1};
  } else {
    launch.pushConstants = pushBytes(parameters);
    launch.groupCount = imageGroups(output.width, runs);
  }
  return launch;
}

/// Checks the vec4 rule and that the view holds at least the shape.
inline void checkHolds(const TensorView& view, const TensorShape& shape) {
  checkView(view, view.shape());
  XRDS_CHECK_LE(shape.height, view.height);
  XRDS_CHECK_LE(shape.width, view.width);
  XRDS_CHECK_LE(shape.channels, view.channels);
}

/// The factors between the resolutions that the network knows: 1, 2, 4, 8 or 16.
inline void checkScale(uint32_t scale) {
  XRDS_CHECK_LE(1u, scale);
  XRDS_CHECK_LE(scale, 16u);
  XRDS_CHECK_EQ(scale & (scale - 1), 0u);
}

}  // namespace xrds
#endif
#endif
