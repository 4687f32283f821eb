/* What there is to know of models, upscalers and devices beside the picture: costs, tiles, times, and whether a device
 * computes what it should. Beside xrds.h, whose head tells of results, handles, threads and structures. Strings in rows
 * are valid as long as the callback that hears them. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_XRDS_REPORT_H
#define XRDS_XRDS_REPORT_H

#include "xrds/xrds.h"

#ifdef __cplusplus
extern "C" {
#endif

/* -------------------------------------------------------------------------------------------------------- Models */

/* The folders in which xrdsFindModel() looks, in this order; NULL beyond the last one. Valid until the next call of
 * this thread. */
XRDS_API const char* xrdsGetModelFolder(uint32_t index);

/* A model without a network: base "bicubic" (no auxiliary image), "demodulated" or "guided" (albedo, normal); transfer
 * "log1p" or "none". */
XRDS_API XrdsResult xrdsCreateUntrainedModel(uint32_t scale, const char* base, const char* transfer, XrdsModel** model);

/* Of the file's bytes, 16 hexadecimal digits; the keys of its metadata, NULL beyond the last one; why its windows are
 * never skipped, as the end of a sentence, "" if XrdsUpscalerOptions.skipBound may be set. Valid until the model is
 * closed; "" or NULL of a handle that is not open. */
XRDS_API const char* xrdsGetModelHash(const XrdsModel* model);
XRDS_API const char* xrdsGetModelMetadataKey(const XrdsModel* model, uint32_t index);
XRDS_API const char* xrdsWhyNeverSkipped(const XrdsModel* model);

/* Of an output in one piece. networkMultiplyAdds: the count of papers, linear maps and convolutions as they are
 * written, without the token pairs of attention. All else is of what devices run: multiply-adds of maps and, beside
 * them, of token pairs; bytes of the arena, of the largest set of values alive at once, of all values, of weights. */
typedef struct XrdsModelCost {
  uint32_t structSize;
  uint64_t parameters, networkMultiplyAdds;
  uint64_t multiplyAdds, attentionMultiplyAdds;
  uint64_t plannedBytes, lowerBoundBytes, unaliasedBytes, weightBytes;
} XrdsModelCost;

/* Needs no device, only its kernels: a name of xrdsGetKernelFamily(). */
XRDS_API XrdsResult xrdsGetModelCost(const XrdsModel* model, uint32_t outputWidth, uint32_t outputHeight, int32_t fp16,
                                     const char* kernelFamily, XrdsModelCost* cost);

/* The tiles of a frame: one and no halo if it is taken as a whole. halo: low-resolution pixels around each; tileWidth
 * and tileHeight: of the largest with its halo, in pixels of the output; work: pixels computed over pixels of it. */
typedef struct XrdsTiling {
  uint32_t structSize;
  uint32_t columns, rows, halo, tileWidth, tileHeight;
  double work;
  uint64_t arenaBytes, weightBytes;
} XrdsTiling;

/* Of an output of that size, without a device; memoryBytes 0 of the options sets no limit here. options may be NULL. */
XRDS_API XrdsResult xrdsPlanTiles(const XrdsModel* model, uint32_t outputWidth, uint32_t outputHeight,
                                  const XrdsUpscalerOptions* options, const char* kernelFamily, XrdsTiling* tiling);

/* -------------------------------------------------------------------------------------------------------- Colour */

/* The share that the full-resolution colour has in the merged one where the samples are not known, from the noise of
 * both; the merged colour of a share; and the full-resolution colour at the level of the merged one, which denoisers
 * take best. As estimatedFullShare(), mergedColour() and levelledColour() of merged_colour.h. */
XRDS_API XrdsResult xrdsEstimateFullShare(const XrdsImage* low, const XrdsImage* full, double* share);
XRDS_API XrdsResult xrdsMergeByShare(const XrdsImage* low, const XrdsImage* full, double share,
                                     const XrdsImage* merged);
XRDS_API XrdsResult xrdsLevelColour(const XrdsImage* full, const XrdsImage* merged, const XrdsImage* levelled);

/* ----------------------------------------------------------------------------------------------------- Upscalers */

/* *pays: whether XRDS_TUNE_AUTO would tune such frames on a device of the library's own. */
XRDS_API XrdsResult xrdsPaysToTune(XrdsDevice* device, const XrdsModel* model, uint32_t width, uint32_t height,
                                   int32_t fp16, int32_t* pays);

/* How the upscaler's frames are cut. The caller sets tiling->structSize. */
XRDS_API XrdsResult xrdsGetTiling(XrdsUpscaler* upscaler, XrdsTiling* tiling);

/* Pixels of the last run that were not finite: of the inputs, filled from their neighbours, and of the network's
 * output, which was left out there. */
typedef struct XrdsRepairs {
  uint32_t structSize;
  uint64_t colour, auxiliary, output;
} XrdsRepairs;

/* The caller sets repairs->structSize. */
XRDS_API XrdsResult xrdsGetRepairs(XrdsUpscaler* upscaler, XrdsRepairs* repairs);

/* What became of each attention window in the last run. side: of a window, in pixels of the output; work: pixels
 * computed over pixels of the frame. */
typedef struct XrdsSkipMap {
  uint32_t structSize;
  uint32_t side, columns, rows;
  double work;
} XrdsSkipMap;

/* windows: columns x rows bytes, by rows: 0 computed, 1 interpolated, 2 kept; may be NULL with a capacity of 0. */
XRDS_API XrdsResult xrdsGetSkipMap(XrdsUpscaler* upscaler, XrdsSkipMap* map, uint8_t* windows, size_t capacity);

/* One dispatch. */
typedef struct XrdsProfileRow {
  uint32_t structSize;
  const char *label, *program;
  uint64_t multiplyAdds, bytes;
  double microseconds;
} XrdsProfileRow;
typedef void (*XrdsHearProfile)(void* user, const XrdsProfileRow* row);

/* Of the last run, in order, of an ensemble of the upscaler's last pass; nothing is heard unless
 * XrdsUpscalerOptions.profile was set. */
XRDS_API XrdsResult xrdsGetProfile(XrdsUpscaler* upscaler, XrdsHearProfile hear, void* user);

/* How far the device is from double precision at one operator. */
typedef struct XrdsCheckRow {
  uint32_t structSize;
  const char* label;
  double relativeRms;
  int32_t finite, withinBound;
} XrdsCheckRow;
typedef void (*XrdsHearCheck)(void* user, const XrdsCheckRow* row);

/* Runs one frame and compares each operator with its reference on the host: seconds for 16 x 16 pixels. Denoisers are
 * not among them: the colour is taken as it is. options may be NULL. */
XRDS_API XrdsResult xrdsCheckFrame(XrdsDevice* device, const XrdsModel* model, const XrdsImage* colour,
                                   const XrdsImage* auxiliary, uint32_t auxiliaryCount,
                                   const XrdsUpscalerOptions* options, XrdsHearCheck hear, void* user);

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
