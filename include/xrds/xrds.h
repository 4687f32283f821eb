/* xrds in C: upscales a noisy low-resolution picture with the help of full-resolution albedo and normals.
 *
 *     XrdsDevice* device;  XrdsModel* model;  XrdsUpscaler* upscaler;
 *     xrdsOpenDevice(NULL, &device);
 *     xrdsOpenModel("xrds-x4-compact", &model);
 *     xrdsCreateUpscaler(device, model, width, height, NULL, &upscaler);
 *     xrdsUpscale(upscaler, &colour, auxiliary, 2, &output, NULL, NULL);
 *
 * Results. Functions that can fail return an XrdsResult, XRDS_OK being 0; xrdsGetMessage() then tells in one sentence
 * what failed, what was expected and found, and what to do. They leave what they should fill untouched.
 *
 * Handles. What is opened or created is closed or destroyed by its own function, in any order: an upscaler keeps its
 * device and model alive. A NULL is nothing to close. A handle that is not open is refused, XRDS_ERROR_ARGUMENT, unless
 * a newer handle got the same address.
 *
 * Threads. Everything may be called from any thread. Calls on one device, and on the upscalers of one device, wait for
 * each other; an upscaler in use on another thread is refused, XRDS_ERROR_BUSY. Models never change and may be shared.
 * Callbacks are heard while the device is taken: they must not call functions of it, nor throw.
 *
 * Structures. `structSize` is sizeof the structure. Later versions add fields behind those of today, which keep their
 * meaning; what a program was built without is as if the default were given, and is not written. XrdsImage,
 * XrdsVulkanImage and XrdsTimelinePoint stay as they are. The functions xrds...Default() fill a structure with what its
 * comments call the default.
 *
 * Strings are UTF-8, owned by the library unless a comment says otherwise. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_XRDS_H
#define XRDS_XRDS_H

#include <stddef.h>
#include <stdint.h>

#include "xrds/export.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct XrdsDevice XrdsDevice;
typedef struct XrdsModel XrdsModel;
typedef struct XrdsUpscaler XrdsUpscaler;
typedef struct XrdsTemporalFilter XrdsTemporalFilter;

typedef enum XrdsResult {
  XRDS_OK = 0,
  XRDS_CANCELLED = 1,            /* a callback returned 0 */
  XRDS_ERROR_ARGUMENT = -1,      /* what was given cannot be: a null pointer, a size, a handle, an option */
  XRDS_ERROR_FAILED = -2,        /* the world: a file, a driver, no device */
  XRDS_ERROR_OUT_OF_MEMORY = -3, /* of the device or the host; less may fit */
  XRDS_ERROR_DEVICE_LOST = -4,   /* what was made on the device is of no more use; it may be opened again */
  XRDS_ERROR_BUSY = -5,          /* the upscaler is in use on another thread */
  XRDS_ERROR_INTERNAL = -6       /* an error of the library: please report the message */
} XrdsResult;

/* The version of the library: 0 for the first, 1 for the second and 2 for the third number of "0.1.0". Any may be
 * NULL. */
XRDS_API void xrdsGetVersion(uint32_t* major, uint32_t* minor, uint32_t* patch);

/* What the last failed call of this thread has to say; "" if none failed. Valid until the next call of the thread. */
XRDS_API const char* xrdsGetMessage(void);

/* ------------------------------------------------------------------------------------------------------- Devices */

typedef struct XrdsDeviceDescription {
  uint32_t structSize;
  char name[256], kind[16]; /* kind: "discrete", "integrated", "virtual", "cpu" or "other" */
  char uuid[33];            /* 32 hexadecimal digits */
  char driver[256], apiVersion[32];
  char kernelFamily[16]; /* of the kernels that it runs: "plain", "lane", "tile", "matrix" or "fused" */
  uint64_t memoryBytes;
} XrdsDeviceDescription;

/* Heard in the calling thread about ten times a second while programs are compiled, when a device is opened and when
 * an upscaler is created. machineCode: 0 while the driver reads programs, seconds at most; 1 while a CPU driver
 * compiles what its cache lacks, minutes once; 2 before each kernel that an upscaler tries as it tunes the device,
 * `done` thousandths of it being done. Returning 0 cancels. */
typedef int (*XrdsPreparation)(void* user, int machineCode, size_t done, size_t total);

/* Heard in any thread, with a text that is valid during the call. */
typedef void (*XrdsMessage)(void* user, const char* text);

typedef struct XrdsDeviceOptions {
  uint32_t structSize;
  const char* select;          /* number, part of the name, or UUID; default NULL: the best device */
  const char* cacheFolder;     /* of compiled programs; default NULL: the user's cache folder */
  const char* kernelFamily;    /* default NULL: what suits the device */
  XrdsPreparation preparation; /* default NULL */
  void* preparationUser;
  int32_t validation;  /* 1: with Vulkan's validation layers, whose messages go to `message`; default 0 */
  XrdsMessage message; /* default NULL */
  void* messageUser;
} XrdsDeviceOptions;

XRDS_API XrdsDeviceOptions xrdsDeviceOptionsDefault(void);

/* How many devices there are; 0 and an error without a Vulkan loader. */
XRDS_API XrdsResult xrdsCountDevices(uint32_t* count);

/* Of the device number `index` below that count. The caller sets description->structSize. */
XRDS_API XrdsResult xrdsDescribeDevice(uint32_t index, XrdsDeviceDescription* description);

/* Opens a device for compute; options may be NULL. */
XRDS_API XrdsResult xrdsOpenDevice(const XrdsDeviceOptions* options, XrdsDevice** device);
/* Of an open device. The caller sets description->structSize. */
XRDS_API XrdsResult xrdsDescribeOpenDevice(XrdsDevice* device, XrdsDeviceDescription* description);
XRDS_API void xrdsCloseDevice(XrdsDevice* device);

/* What a user should know of how the device was opened, a sentence each: a cache folder that cannot be written. NULL
 * beyond the last one. Valid until the device is closed. */
XRDS_API const char* xrdsGetDeviceNote(XrdsDevice* device, uint32_t index);

/* The names of the versions of the kernels; NULL beyond the last one. */
XRDS_API const char* xrdsGetKernelFamily(uint32_t index);

/* -------------------------------------------------------------------------------------------------------- Models */

/* The file of a shipped model, as "xrds-x4-compact", with its final zero into path[capacity]. Looked for in the folder
 * of the environment variable XRDS_MODELS, in share/xrds/models of the library's folder and those above it (as
 * installed: lib, lib/x86_64-linux-gnu or bin beside share), and in the source tree. Fails if there is none or no room.
 */
XRDS_API XrdsResult xrdsFindModel(const char* name, char* path, size_t capacity);

/* The name of the shipped model that suits frames with these images beside the colour, each named as
 * xrdsGetModelInput() does and of `scale` times the colour's size, with its final zero into name[capacity]. samples: of
 * a pixel of the colour, 0 if that is not known; few take a model of few samples. Without images the model of the
 * colour alone, scale 4 whatever `scale` is. Fails if no model of the scale is shipped, or no room. */
XRDS_API XrdsResult xrdsChooseModel(uint32_t scale, const char* const* inputs, uint32_t inputCount, double samples,
                                    char* name, size_t capacity);

/* Reads a model: a .safetensors file, or the name of a shipped one. */
XRDS_API XrdsResult xrdsOpenModel(const char* nameOrFile, XrdsModel** model);
XRDS_API void xrdsCloseModel(XrdsModel* model);

/* Output pixels to a side of a colour pixel; 0 of a handle that is not open. */
XRDS_API uint32_t xrdsGetModelScale(const XrdsModel* model);

/* The images beside the colour, in the order of xrdsUpscale(); the names "albedo", "normal", "depth", "diffuse",
 * "glossy" and "colour". NULL beyond the last one. Valid until the model is closed. */
XRDS_API uint32_t xrdsCountModelInputs(const XrdsModel* model);
XRDS_API const char* xrdsGetModelInput(const XrdsModel* model, uint32_t index);

/* A field of the model file's metadata, as "license"; NULL if it has none. Valid until the model is closed. */
XRDS_API const char* xrdsGetModelMetadata(const XrdsModel* model, const char* key);

/* Reads the networks of Open Image Denoise's RT filter out of the user's own library, or of one file NAME.tza, and writes
 * each as a model file folder/NAME.safetensors; the folder is made if it is not there. hear, which may be NULL, is told
 * each file. Models of scale 1: they take the noise out of a colour, with albedo and normal, or of what they are named
 * after, which then is their colour. */
XRDS_API XrdsResult xrdsImportOidn(const char* library, const char* folder, XrdsMessage hear, void* user);

/* Where such files are looked for: $XRDS_DENOISERS, $XDG_DATA_HOME/xrds/denoisers, ~/.local/share/xrds/denoisers, on
 * Windows %LOCALAPPDATA%\xrds\denoisers. "" if the environment names none. Valid until the next call of this thread. */
XRDS_API const char* xrdsGetDenoiserFolder(void);

/* -------------------------------------------------------------------------------------------------------- Images */

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
 * every other one better. lowSamples and fullSamples: of a pixel; both 0: estimated from the noise. merged has the size
 * of `low`; its alpha is that of `low`. */
XRDS_API XrdsResult xrdsMergeColour(const XrdsImage* low, const XrdsImage* full, double lowSamples, double fullSamples,
                                    const XrdsImage* merged);

/* How much the two colours differ beside noise, their relative difference in parts of the frame: above 0.1 they are of
 * other light (a full-resolution render without indirect light, say), and must not be merged. */
XRDS_API XrdsResult xrdsCompareColour(const XrdsImage* low, const XrdsImage* full, double* difference);

/* ----------------------------------------------------------------------------------------------------- Upscaling */

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
 * count as their neighbours. progress may be NULL; after XRDS_CANCELLED the output holds anything. */
XRDS_API XrdsResult xrdsUpscale(XrdsUpscaler* upscaler, const XrdsImage* colour, const XrdsImage* auxiliary,
                                uint32_t auxiliaryCount, const XrdsImage* output, XrdsProgress progress, void* user);

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
 * lights times their colour. Refused if the upscaler leaves out windows or is part of a recording. Another number of
 * layers than in the run before plans anew. reports: one a set, whose structSize the caller sets, or NULL. */
XRDS_API XrdsResult xrdsUpscaleLayers(XrdsUpscaler* upscaler, const XrdsImage* colour, const XrdsImage* auxiliary,
                                      uint32_t auxiliaryCount, const XrdsImage* output, const XrdsLayerSet* sets,
                                      uint32_t setCount, XrdsLayerReport* reports, XrdsProgress progress, void* user);

/* Of the last run; 0 of a handle that is not open. */
XRDS_API float xrdsGetExposure(const XrdsUpscaler* upscaler);

/* Device memory that an upscaler holds, bytes; 0 of a handle that is not open. */
XRDS_API uint64_t xrdsGetDeviceBytes(const XrdsUpscaler* upscaler);

/* ---------------------------------------------------------------------------------------------------- Animations */

/* A frame of an animation. Images whose channels are NULL are not there; every frame has the same ones. Of `merged` the
 * images and counts are written, those that are not there left out; the other numbers do not count. */
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

/* The frame merged with those before and after it, in order, the nearest first; five of each side are worth it. The
 * result depends on these frames alone. */
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
