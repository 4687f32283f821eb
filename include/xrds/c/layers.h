/* Frames are upscaled with the lights that they are the sum of. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_C_LAYERS_H
#define XRDS_C_LAYERS_H

#include "xrds/c/upscaler.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A light that the colour of a render is the sum of, beside others: diffuse, emission, a light group. */
typedef struct XrdsLayer {
  uint32_t structSize;
  int32_t colour;        /* place in XrdsLayerSet::colours of the pass that multiplies it; default -1: it is radiance */
  XrdsImage light;       /* [h, w] of the low-resolution render */
  XrdsImage output;      /* [scale h, scale w], not negative */
  int32_t followsAlbedo; /* of radiance: 1, the default; 0 for emission, environment and volumes */
} XrdsLayer;

/* A colour pass, as Cycles' DiffCol: its lights times it are radiance. */
typedef struct XrdsLayerColour {
  uint32_t structSize;
  XrdsImage low, full; /* [h, w] and [scale h, scale w] of the two renders; `full` NULL channels: `low`, filtered */
  XrdsImage output;    /* [scale h, scale w]: `full`, raised where a light has no place in it */
} XrdsLayerColour;

/* Layers that add up to the colour: the passes of Cycles, say; light groups are another set. */
typedef struct XrdsLayerSet {
  uint32_t structSize;
  uint32_t layerCount, colourCount;
  const XrdsLayer* layers;
  const XrdsLayerColour* colours;
  const XrdsImage* whole; /* what the layers are part of, [h, w]; default NULL: the colour. The unmerged one, say */
} XrdsLayerSet;

typedef struct XrdsLayerReport {
  uint32_t structSize;
  double share;           /* of the whole that the layers make up; from 0.99 on they are made to sum to the output */
  uint64_t raisedColours; /* pixels of colour passes that are not those of `full` */
  uint64_t unshared;      /* pixels with light in a channel in which every layer is black everywhere */
} XrdsLayerReport;

XRDS_API XrdsLayer xrdsLayerDefault(void);
XRDS_API XrdsLayerColour xrdsLayerColourDefault(void);
XRDS_API XrdsLayerSet xrdsLayerSetDefault(void);

/* xrdsUpscale() with layers, which are upscaled so that each of the sets still adds up to the output: radiance, and
 * lights times their colour. Refused if the upscaler leaves out windows, and while it is part of a recording. Another
 * number of layers than in the run before plans anew. reports: one a set, whose structSize the caller sets, or NULL. */
XRDS_API XrdsResult xrdsUpscaleLayers(XrdsUpscaler* upscaler, const XrdsImage* colour, const XrdsImage* auxiliary,
                                      uint32_t auxiliaryCount, const XrdsImage* output, const XrdsLayerSet* sets,
                                      uint32_t setCount, XrdsLayerReport* reports, XrdsProgress progress, void* user);

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
