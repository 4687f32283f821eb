/* Whether a device computes what it should. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_C_EXAMINATION_H
#define XRDS_C_EXAMINATION_H

#include "xrds/c/device.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a device offers beyond Vulkan 1.2, as far as it decides how kernels run. */
typedef struct XrdsDeviceCapabilities {
  uint32_t structSize;
  char kernelFamily[16];
  char matrixUnits[8];   /* Vulkan's way to them: "nv", "khr" or "none" */
  int32_t matrixTrusted; /* they gave right products when the device was opened; in use in fp16 only */
  uint32_t subgroupSize;
  int32_t int64;            /* 64-bit integers in shaders, also in subgroup operations */
  int32_t timestamps;       /* the device times its own work */
  uint64_t maxBindingBytes; /* of a storage buffer; larger tensors are bound in bands */
  uint64_t maxTensorTexels; /* four channels each, of a tensor that kernels read; larger frames need tiles */
} XrdsDeviceCapabilities;

/* Of an open device. The caller sets capabilities->structSize. */
XRDS_API XrdsResult xrdsGetDeviceCapabilities(XrdsDevice* device, XrdsDeviceCapabilities* capabilities);

/* One kernel on a small tensor of random numbers, against double precision and against itself. rms, max: difference
 * over the RMS of the reference; microseconds: of the fastest run. */
typedef struct XrdsKernelExamination {
  uint32_t structSize;
  const char *program, *node, *shapes; /* node, shapes: where a network uses it, and on what */
  double rms, max, rmsBound, maxBound;
  int32_t finite, repeatable; /* repeatable: every run gave the same bits */
  double microseconds;
} XrdsKernelExamination;
typedef void (*XrdsHearKernel)(void* user, const XrdsKernelExamination* kernel);

/* Every kernel with which the device runs networks like the shipped ones, each `runs` times, at least once: seconds. */
XRDS_API XrdsResult xrdsExamineKernels(XrdsDevice* device, int32_t fp16, uint32_t runs, XrdsHearKernel hear,
                                       void* user);

/* A network of a shipped one's shape with made-up weights, on a made-up frame whose answer is known. width, height: of
 * the output. */
typedef struct XrdsFrameExamination {
  uint32_t structSize;
  uint32_t width, height;
  int32_t finite, repeatable;
  double rms, rmsBound, microseconds;
} XrdsFrameExamination;

/* Upscales that frame `runs` times, at least once: seconds. The caller sets frame->structSize. */
XRDS_API XrdsResult xrdsExamineKnownFrame(XrdsDevice* device, int32_t fp16, uint32_t runs, XrdsFrameExamination* frame);

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
