/* Hostile images and weights. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_C_STRESS_H
#define XRDS_C_STRESS_H

#include "xrds/c/model.h"
#include "xrds/c/upscaler.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct XrdsStressOptions {
  uint32_t structSize;
  uint32_t modelCount;
  const char* const* names; /* of the models, beside random ones */
  const XrdsModel* const* models;
  int32_t randomModels; /* default 1 */
  uint32_t seed;        /* default 1 */
  int32_t shortForm;    /* 1: some thousand cases of nine random models, a minute; default 0 */
  /* Heard after each row with the finished share; returning 0 ends the run with what there is. Default NULL. */
  XrdsProgress progress;
  void* user;
} XrdsStressOptions;

XRDS_API XrdsStressOptions xrdsStressOptionsDefault(void);

/* One model with one change to its weights, in one precision and kernel family, over all inputs; the fields are those
 * of StressRow in stress.h. */
typedef struct XrdsStressRow {
  uint32_t structSize;
  const char *model, *weights, *precision, *family, *worstInput, *firstDegraded;
  const char* const* promoted;
  uint32_t promotedCount;
  int32_t bounded, replaysExactly, bandsExactly, tilesExactly;
  uint64_t cases, nonFiniteOutputs, casesInParts, repairedPixels, lostPixels, naturalCases, litFromBlack;
  double worstError, worstScaling, worstSkip;
} XrdsStressRow;

/* The largest error of an operator alone, on what the device gave it, over all natural inputs. */
typedef struct XrdsStressOperator {
  uint32_t structSize;
  const char *name, *precision, *family, *where;
  double worstError, budget;
} XrdsStressOperator;

typedef struct XrdsStressReport {
  uint32_t structSize;
  uint32_t seed;
  double fp32Bound, fp16Bound, fp32ScalingBound, fp16ScalingBound;
  const char *const *colours, *const *auxiliaries;
  uint32_t colourCount, auxiliaryCount, rowCount, operatorCount;
  const XrdsStressRow* const* rows;
  const XrdsStressOperator* const* operators;
} XrdsStressReport;
typedef void (*XrdsHearStress)(void* user, const XrdsStressReport* report);

/* Tries hostile images and weights, minutes, and tells once. options may be NULL. */
XRDS_API XrdsResult xrdsStress(XrdsDevice* device, const XrdsStressOptions* options, XrdsHearStress hear, void* user);

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
