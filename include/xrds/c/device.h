/* The devices that there are, and opening them. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_C_DEVICE_H
#define XRDS_C_DEVICE_H

#include "xrds/c/result.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct XrdsDevice XrdsDevice;

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

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
