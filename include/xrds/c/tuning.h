/* Which kernels are the fastest on a device. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_C_TUNING_H
#define XRDS_C_TUNING_H

#include "xrds/c/device.h"
#include "xrds/c/model.h"

#ifdef __cplusplus
extern "C" {
#endif

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
  uint32_t structSize;
  uint32_t nodes;               /* of the model */
  const char* name;             /* the operator and its channels: "linear 64 > 192" */
  const char *kernel, *fixed;   /* that won, and the fixed choice of the device's family */
  double seconds, fixedSeconds; /* of a frame, in this operator */
  uint64_t tried;               /* kernels */
  const char* const* wrong;     /* those that were, and how */
  uint32_t wrongCount;
} XrdsTunedShape;

typedef struct XrdsStruckOff {
  uint32_t structSize;
  const char *program, *why;
} XrdsStruckOff;

/* What is known of a model in frames of a size. */
typedef struct XrdsTuningReport {
  uint32_t structSize;
  int32_t taken; /* the winners are used; else whole frames gained nothing, and the fixed choice is */
  int32_t normsInLinear, layersFused;
  double seconds, fixedSeconds; /* of a frame, measured in turns; 0: both are the same */
  double tuningSeconds;
  int64_t date;                          /* when it was tuned, in seconds since 1970 */
  uint64_t measured;                     /* kernels that were tried now; 0: all was known */
  const XrdsTunedShape* const* shapes;   /* the slowest first */
  const XrdsStruckOff* const* struckOff; /* of the device's driver */
  uint32_t shapeCount, struckOffCount;
  const char* unkept; /* why this process alone knows what xrdsTune() found; NULL: it is kept */
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

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
