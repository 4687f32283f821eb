/* Frames of an animation are merged. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_C_TEMPORAL_FILTER_H
#define XRDS_C_TEMPORAL_FILTER_H

#include "xrds/c/device.h"
#include "xrds/c/image.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct XrdsTemporalFilter XrdsTemporalFilter;

/* A frame of an animation. Images whose channels are NULL are not there; every frame has the same ones. Pixels of them
 * that are not finite count as their neighbours. Of `merged` the images and counts are written, those that are not
 * there left out; the other numbers do not count. */
typedef struct XrdsTemporalFrame {
  uint32_t structSize;
  XrdsImage colour;                     /* [h, w] linear radiance */
  XrdsImage fullColour, albedo, normal; /* [scale h, scale w]; NULL channels: none */
  const float* depth;                   /* [scale h, scale w] distances in any unit; NULL: none */
  /* [scale h, scale w, 2] pixels from what a pixel shows to where the frame before and the one after it show that, x to
   * the right and y down; NULL: frames of that side cannot be used. */
  const float *toPrevious, *toNext;
  /* [h, w] and [scale h, scale w]: how many frames a pixel of the two radiances is the mean of; NULL: one. Written of
   * `merged`. For live pictures `before` is the last result alone, with its counts. */
  float *lowCounts, *fullCounts;
} XrdsTemporalFrame;

XRDS_API XrdsTemporalFrame xrdsTemporalFrameDefault(void); /* nothing is there */

/* Merges frames of width x height low-resolution pixels with those around them: less flicker and noise in what an
 * upscaler makes of them. Takes the device memory that it needs. */
XRDS_API XrdsResult xrdsCreateTemporalFilter(XrdsDevice* device, uint32_t width, uint32_t height, uint32_t scale,
                                             XrdsTemporalFilter** filter);
XRDS_API void xrdsDestroyTemporalFilter(XrdsTemporalFilter* filter);

/* The frame merged with those before and after it, in order, the nearest first; five of each side are worth it,
 * ten while most of the picture stands still. The result depends on these frames alone. */
XRDS_API XrdsResult xrdsMergeFrames(XrdsTemporalFilter* filter, const XrdsTemporalFrame* present,
                                    const XrdsTemporalFrame* before, uint32_t beforeCount,
                                    const XrdsTemporalFrame* after, uint32_t afterCount,
                                    const XrdsTemporalFrame* merged);

/* Device memory that a filter holds, bytes; 0 of a handle that is not open. */
XRDS_API uint64_t xrdsGetTemporalDeviceBytes(const XrdsTemporalFilter* filter);

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
