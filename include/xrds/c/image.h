/* Pixels of the caller, and the colours of the two renders of a frame. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_C_IMAGE_H
#define XRDS_C_IMAGE_H

#include "xrds/c/result.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum XrdsFormat { XRDS_FLOAT = 0, XRDS_HALF = 1 } XrdsFormat; /* 32 and 16 bits a number */

/* Pixels of the caller, in any layout. channels: the numbers of the top left pixel, in the order red, green, blue (of a
 * normal x, y, z; of distances one alone) and alpha, which may be NULL. A plane each, or interleaved. */
typedef struct XrdsImage {
  void* channels[4];
  ptrdiff_t pixelStride, rowStride; /* bytes to the pixel on the right and to the row below; may be negative */
  uint32_t width, height;
  XrdsFormat format;
} XrdsImage;

/* Rows from the top without gaps, `channelCount` numbers a pixel: 1, 3, or 4 with alpha. */
XRDS_API XrdsImage xrdsInterleavedImage(void* pixels, XrdsFormat format, uint32_t channelCount, uint32_t width,
                                        uint32_t height);

/* The low-resolution colour of a render and the colour of its full-resolution one, whose albedo and normals are the
 * auxiliary images, as their mean weighted by samples: what models take that have the input "colour", and what makes
 * every other one better. lowSamples and fullSamples: of a pixel; both 0: estimated from the noise. Pixels of both that
 * are not finite count as their neighbours. merged has the size of `low`; its alpha is that of `low`. */
XRDS_API XrdsResult xrdsMergeColour(const XrdsImage* low, const XrdsImage* full, double lowSamples, double fullSamples,
                                    const XrdsImage* merged);

/* How much the two colours differ beside noise, their relative difference in parts of the frame: above 0.1 they are of
 * other light (a full-resolution render without indirect light, say), and must not be merged. */
XRDS_API XrdsResult xrdsCompareColour(const XrdsImage* low, const XrdsImage* full, double* difference);

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
