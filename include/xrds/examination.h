#pragma once

#include "xrds/device.h"
#include "xrds/xrds_examine.h"

namespace xrds {

/// What a device offers beyond Vulkan 1.2, as far as it decides how kernels run.
struct DeviceCapabilities {
  /// One of Device::kernelFamilies(). An operator without kernels of it falls back: "fused" to "matrix", "matrix" to
  /// "tile", all to "plain".
  std::string kernelFamily;
  std::string matrixUnits = "none";  // Vulkan's way to them: "nv", "khr" or "none"
  bool matrixTrusted = false;        // they gave right products when the device was opened; in use in fp16 only
  uint32_t subgroupSize = 0;
  bool int64 = false;            // 64-bit integers in shaders, also in subgroup operations
  bool timestamps = false;       // the device times its own work
  uint64_t maxBindingBytes = 0;  // of a storage buffer; larger tensors are bound in bands
  uint64_t maxTensorTexels = 0;  // four channels each, of a tensor that kernels read; larger frames need tiles
};

/// One kernel on a small tensor of random numbers, against its double-precision reference and against itself.
struct KernelExamination {
  std::string program;       // operator, family and storage of the output: "linear_lane_f16"
  std::string node, shapes;  // where the network uses it, and on what
  double rms = 0, max = 0;   // difference over the RMS of the reference
  double rmsBound = 0, maxBound = 0;
  bool finite = true;
  bool repeatable = true;   // every run gave the same bits
  double microseconds = 0;  // of the fastest run; of the device's own clock where it has one

  bool withinBound() const { return finite && rms <= rmsBound && max <= maxBound; }
};

/// A small frame whose answer is known, stored as computed in double precision.
struct FrameExamination {
  uint32_t width = 0, height = 0;  // of the output
  double rms = 0, rmsBound = 0;    // difference over the RMS of the answer
  bool finite = true, repeatable = true;
  double microseconds = 0;  // of the fastest run, from the upload to the result

  bool withinBound() const { return finite && rms <= rmsBound; }
};

/// Whether a device computes what it should: each takes seconds, most of them to compile programs. Throws Error if the
/// device fails.
struct Examination {
  static DeviceCapabilities capabilities(Device& device);

  /// Every kernel with which the device runs networks like the shipped ones, each `runs` times (at least once).
  static std::vector<KernelExamination> kernels(Device& device, bool fp16, uint32_t runs);

  /// A network of a shipped one's shape with made-up weights, on a made-up frame, `runs` times (at least once).
  static FrameExamination knownFrame(Device& device, bool fp16, uint32_t runs);
};

inline DeviceCapabilities Examination::capabilities(Device& device) {
  auto found = call::sized<XrdsDeviceCapabilities>();
  call::check(xrdsGetDeviceCapabilities(device.handle(), &found));
  return {.kernelFamily = found.kernelFamily,
          .matrixUnits = found.matrixUnits,
          .matrixTrusted = found.matrixTrusted != 0,
          .subgroupSize = found.subgroupSize,
          .int64 = found.int64 != 0,
          .timestamps = found.timestamps != 0,
          .maxBindingBytes = found.maxBindingBytes,
          .maxTensorTexels = found.maxTensorTexels};
}

inline std::vector<KernelExamination> Examination::kernels(Device& device, bool fp16, uint32_t runs) {
  std::vector<KernelExamination> kernels;
  const auto add = [&](const XrdsKernelExamination* found) {
    kernels.push_back({.program = found->program,
                       .node = found->node,
                       .shapes = found->shapes,
                       .rms = found->rms,
                       .max = found->max,
                       .rmsBound = found->rmsBound,
                       .maxBound = found->maxBound,
                       .finite = found->finite != 0,
                       .repeatable = found->repeatable != 0,
                       .microseconds = found->microseconds});
  };
  call::Heard heard(add);
  const XrdsResult result = xrdsExamineKernels(
      device.handle(), fp16, runs, decltype(heard)::template listen<const XrdsKernelExamination*>, heard.user());
  heard.finish(XRDS_OK);
  device.finish(result);
  return kernels;
}

inline FrameExamination Examination::knownFrame(Device& device, bool fp16, uint32_t runs) {
  auto found = call::sized<XrdsFrameExamination>();
  device.finish(xrdsExamineKnownFrame(device.handle(), fp16, runs, &found));
  return {.width = found.width,
          .height = found.height,
          .rms = found.rms,
          .rmsBound = found.rmsBound,
          .finite = found.finite != 0,
          .repeatable = found.repeatable != 0,
          .microseconds = found.microseconds};
}

}  // namespace xrds
