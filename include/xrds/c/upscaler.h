/* Frames are upscaled. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_C_UPSCALER_H
#define XRDS_C_UPSCALER_H

#include "xrds/c/device.h"
#include "xrds/c/image.h"
#include "xrds/c/model.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct XrdsUpscaler XrdsUpscaler;

/* Whether the kernels of the device are tuned for the frame where that was not done: minutes on a CPU, seconds on a
 * GPU. AUTO: only where a frame takes at least a minute by what was measured on the device before. What an earlier
 * tuning found is used in any case. */
typedef enum XrdsTune { XRDS_TUNE_AUTO = 0, XRDS_TUNE_NEVER = 1, XRDS_TUNE_NOW = 2 } XrdsTune;

/* Heard in the calling thread with the finished share in [0, 1]; returning 0 cancels. */
typedef int (*XrdsProgress)(void* user, double share);

typedef struct XrdsUpscalerOptions {
  uint32_t structSize;
  int32_t fp16;          /* 1: activations and weights are stored as halves, half of the memory; default 0 */
  float exposure;        /* factor on the colour, 1e-30 to 1e30; default 0: from the mean log luminance of each frame */
  uint32_t ensemble;     /* passes over mirrored images: 1, 2, 4 or 8; default 1 */
  uint64_t memoryBytes;  /* of the device at most; a larger frame is cut into tiles; default 0: three quarters */
  float skipBound;       /* windows that change by less are interpolated, as 0.005; default 0: none */
  int32_t keepUnchanged; /* 1: windows whose inputs did not change since the last run keep their result; default 0 */
  XrdsTune tune;         /* default XRDS_TUNE_AUTO */
  /* A run is cut into submissions of about that much work, so that others need not wait longer for the device. */
  uint64_t multiplyAddsPerSubmission; /* default 2^34 */
  /* How a frame is cut that does not fit. */
  int32_t exactTiles;             /* 1: with the bits of the whole frame, for more work; default 0 */
  int32_t wrap;                   /* 1: its left and right borders continue into each other; default 0 */
  int64_t tileHalo;               /* low-resolution pixels, whole windows; default -1: as exactTiles has it */
  uint32_t tileColumns, tileRows; /* default 0: what fits with the least work */
  XrdsProgress tuning;            /* hears of a tuning in place of the device's `preparation`; default NULL */
  void* tuningUser;
  int32_t profile; /* 1: each dispatch is timed for xrdsGetProfile(); default 0 */
  /* Networks of Open Image Denoise (xrdsImportOidn()) that take the noise out of the images first: of albedo and
   * normal, each by its own, NULL where it has no noise; then of light at their resolution, with these; then of the
   * colour, with their box means. Their exposure is their own. Between them nothing leaves the device; but with an
   * ensemble, of which so many passes are theirs, skipBound, keepUnchanged, wrap, layers, each of which is denoised, or
   * where they find no room together, they run one after the other. Then they cannot be recorded. Default NULL: none;
   * with `denoiser` NULL both others are, too. */
  const XrdsModel* denoiser; /* for HDR colour with as many guides as the model has of albedo and normal, or fewer */
  const XrdsModel* albedoDenoiser;
  const XrdsModel* normalDenoiser;
  /* 1: the colour was denoised before. Of what the model changes in it only the part is taken that its file states
   * ("denoised_darker", "denoised_brighter"; of most models all). With `denoiser` it is so in any case. Default 0. */
  int32_t denoisedColour;
  int32_t separateDenoisers; /* 1: they run one after the other in any case, each in all of memoryBytes; default 0 */
  /* 1: of denoisers' images a full-resolution colour is brought to the level of the other one (xrdsLevelColour()), as
   * it must be. In an ensemble a share of the picture is made of both as they are given. Default 0: it is there. */
  int32_t levelColour;
} XrdsUpscalerOptions;

XRDS_API XrdsUpscalerOptions xrdsUpscalerOptionsDefault(void);

/* Makes a model ready for frames of width x height low-resolution pixels; options may be NULL. Slow, once for a size:
 * programs are compiled, memory is planned and taken. */
XRDS_API XrdsResult xrdsCreateUpscaler(XrdsDevice* device, const XrdsModel* model, uint32_t width, uint32_t height,
                                       const XrdsUpscalerOptions* options, XrdsUpscaler** upscaler);
XRDS_API void xrdsDestroyUpscaler(XrdsUpscaler* upscaler);

/* Upscales one frame and waits for it. colour: [h, w] linear radiance. auxiliary: the model's inputs in their order,
 * each [scale h, scale w]; of "depth" one channel of distances in any unit. output: [scale h, scale w] linear radiance,
 * finite whatever the inputs; its alpha, if it has one, is the colour's, interpolated, or 1. Pixels that are not finite
 * count as their neighbours. progress may be NULL; after XRDS_CANCELLED the output holds anything. The
 * output shares no memory with the inputs. */
XRDS_API XrdsResult xrdsUpscale(XrdsUpscaler* upscaler, const XrdsImage* colour, const XrdsImage* auxiliary,
                                uint32_t auxiliaryCount, const XrdsImage* output, XrdsProgress progress, void* user);

/* Of the last run, while one goes on that before it; 0 of a handle that is not open, and before the first run. */
XRDS_API float xrdsGetExposure(const XrdsUpscaler* upscaler);

/* Device memory that an upscaler holds, bytes, while it runs that before the run; 0 of a handle that is not open. */
XRDS_API uint64_t xrdsGetDeviceBytes(const XrdsUpscaler* upscaler);

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
