/* Model files: found, chosen and read. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_C_MODEL_H
#define XRDS_C_MODEL_H

#include "xrds/c/device.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct XrdsModel XrdsModel;

/* The file of a shipped model, as "xrds-x4-compact", with its final zero into path[capacity]. Looked for in the folder
 * of the environment variable XRDS_MODELS, in share/xrds/models of the library's folder and those above it (as
 * installed: lib, lib/x86_64-linux-gnu or bin beside share), and in the source tree. Fails if there is none, when the
 * message lists the shipped models, or no room. */
XRDS_API XrdsResult xrdsFindModel(const char* name, char* path, size_t capacity);

/* The name of the shipped model that suits frames with these images beside the colour, each named as
 * xrdsGetModelInput() does and of `scale` times the colour's size, with its final zero into name[capacity]. samples: of
 * a pixel of the colour, 0 if that is not known; few take a model of few samples. Without images the model of the
 * colour alone, scale 4 whatever `scale` is; images of other names have no say. Fails if no model of the scale is
 * shipped, or no room. */
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

/* Reads the networks of Open Image Denoise's RT filter out of the user's own library, or of one file NAME.tza, and
 * writes each as a model file folder/NAME.safetensors; the folder is made if it is not there. hear, which may be NULL,
 * is told each file. Models of scale 1: they take the noise out of a colour, with albedo and normal, or of what they
 * are named after, which then is their colour. */
XRDS_API XrdsResult xrdsImportOidn(const char* library, const char* folder, XrdsMessage hear, void* user);

/* Where such files are looked for: $XRDS_DENOISERS, $XDG_DATA_HOME/xrds/denoisers, ~/.local/share/xrds/denoisers, on
 * Windows %LOCALAPPDATA%\xrds\denoisers. "" if the environment names none. Valid until the next call of this thread. */
XRDS_API const char* xrdsGetDenoiserFolder(void);

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
