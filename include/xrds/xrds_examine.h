/* Whether a device computes what it should, and which kernels are the fastest on it. Beside xrds.h, whose head tells of
 * results, handles, threads and structures. Strings and lists in what a callback hears are valid as long as the call.
 */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_XRDS_EXAMINE_H
#define XRDS_XRDS_EXAMINE_H

#include "xrds/xrds.h"

#ifdef __cplusplus
extern "C" {
#endif

/* --------------------------------------------------------------------------------------------------- Examination */

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

XRDS_API XrdsResult xrdsExamineKnownFrame(XrdsDevice* device, int32_t fp16, uint32_t runs, XrdsFrameExamination* frame);

/* -------------------------------------------------------------------------------------------------------- Tuning */

typedef struct XrdsTuningOptions {
  uint32_t structSize;
  int32_t fp16, anew; /* anew: 1: forgets what is known of the device, struck-off kernels, too */
  const char* label;  /* what xrdsDescribeTuning() calls the model; default NULL: its hash */
  /* Heard before each kernel with the share done in [0, 1] and what is tried next; returning 0 cancels, and keeps what
   * is known by then. Default NULL. */
  int (*progress)(void* user, double share, const char* text);
  void* user;
} XrdsTuningOptions;

/* One operator of the model, in all its places. */
typedef struct XrdsTunedShape {
  const char* name;             /* the operator and its channels: "linear 64 > 192" */
  const char *kernel, *fixed;   /* that won, and the fixed choice of the device's family */
  double seconds, fixedSeconds; /* of a frame, in this operator */
  uint64_t tried;               /* kernels */
  const char* const* wrong;     /* those that were, and how */
  uint32_t wrongCount;
  uint32_t nodes; /* of the model */
} XrdsTunedShape;

typedef struct XrdsStruckOff {
  const char *program, *why;
} XrdsStruckOff;

/* What is known of a model in frames of a size. */
typedef struct XrdsTuningReport {
  uint32_t structSize;
  int32_t taken; /* the winners are used; else whole frames gained nothing, and the fixed choice is */
  int32_t normsInLinear, layersFused;
  double seconds, fixedSeconds; /* of a frame, measured in turns; 0: both are the same */
  double tuningSeconds;
  int64_t date;                   /* when it was tuned, in seconds since 1970 */
  uint64_t measured;              /* kernels that were tried now; 0: all was known */
  const XrdsTunedShape* shapes;   /* the slowest first */
  const XrdsStruckOff* struckOff; /* of the device's driver */
  uint32_t shapeCount, struckOffCount;
} XrdsTuningReport;
typedef void (*XrdsHearTuning)(void* user, const XrdsTuningReport* report);

/* Tries the kernels for frames of width x height low-resolution pixels, keeps the winners in the cache folder, and
 * tells once. Seconds on a GPU, minutes on a CPU. After XRDS_ERROR_DEVICE_LOST open the device anew and call it again:
 * the kernel is struck off. options may be NULL. */
XRDS_API XrdsResult xrdsTune(XrdsDevice* device, const XrdsModel* model, uint32_t width, uint32_t height,
                             const XrdsTuningOptions* options, XrdsHearTuning hear, void* user);

/* What an earlier tuning found for such frames, or frames of a quarter to four times as many pixels; nothing is heard
 * if there was none, or driver or kernels have changed since. */
XRDS_API XrdsResult xrdsGetTuning(XrdsDevice* device, const XrdsModel* model, uint32_t width, uint32_t height,
                                  int32_t fp16, XrdsHearTuning hear, void* user);

/* All that is known of the device: a line for each model and size, for people. */
XRDS_API XrdsResult xrdsDescribeTuning(XrdsDevice* device, XrdsMessage hear, void* user);

/* -------------------------------------------------------------------------------------------------------- Stress */

typedef struct XrdsStressOptions {
  uint32_t structSize;
  uint32_t modelCount;
  const char* const* names; /* of the models, beside random ones */
  const XrdsModel* const* models;
  int32_t randomModels; /* default 1 */
  uint32_t seed;        /* default 1 */
  int32_t shortForm;    /* 1: some hundred cases of two random models, seconds instead of minutes; default 0 */
  /* Heard after each row with the finished share; returning 0 ends the run with what there is. Default NULL. */
  XrdsProgress progress;
  void* user;
} XrdsStressOptions;

XRDS_API XrdsStressOptions xrdsStressOptionsDefault(void);

/* One model with one change to its weights, in one precision and kernel family, over all inputs; the fields are those
 * of StressRow in stress.h. */
typedef struct XrdsStressRow {
  const char *model, *weights, *precision, *family, *worstInput, *firstDegraded;
  const char* const* promoted;
  uint32_t promotedCount;
  int32_t bounded, replaysExactly, bandsExactly, tilesExactly;
  uint64_t cases, nonFiniteOutputs, casesInParts, repairedPixels, lostPixels, naturalCases, litFromBlack;
  double worstError, worstScaling, worstSkip;
} XrdsStressRow;

/* The largest error of an operator alone, on what the device gave it, over all natural inputs. */
typedef struct XrdsStressOperator {
  const char *name, *precision, *family, *where;
  double worstError, budget;
} XrdsStressOperator;

typedef struct XrdsStressReport {
  uint32_t structSize;
  uint32_t seed;
  double fp32Bound, fp16Bound, fp32ScalingBound, fp16ScalingBound;
  const char *const *colours, *const *auxiliaries;
  uint32_t colourCount, auxiliaryCount, rowCount, operatorCount;
  const XrdsStressRow* rows;
  const XrdsStressOperator* operators;
} XrdsStressReport;
typedef void (*XrdsHearStress)(void* user, const XrdsStressReport* report);

/* Tries hostile images and weights, minutes, and tells once. options may be NULL. */
XRDS_API XrdsResult xrdsStress(XrdsDevice* device, const XrdsStressOptions* options, XrdsHearStress hear, void* user);

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
