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
 * xrdsPrepareVulkan(), and what opens or lists devices of the library's own, may set variables of the environment for
 * Mesa's driver for CPUs: meanwhile no other thread of the program may read or change the environment.
 *
 * Structures. `structSize` is sizeof the structure. Later versions add fields behind those of today, which keep their
 * meaning; what a program was built without is as if the default were given, and is not written. The structures of a
 * list have one size. XrdsImage, XrdsVulkanImage and XrdsTimelinePoint stay as they are. The functions xrds...Default()
 * fill a structure with what its comments call the default.
 *
 * Strings are UTF-8, owned by the library unless a comment says otherwise. */
#ifndef XRDS_XRDS_H
#define XRDS_XRDS_H

#include "xrds/c/device.h"
#include "xrds/c/image.h"
#include "xrds/c/layers.h"
#include "xrds/c/model.h"
#include "xrds/c/result.h"
#include "xrds/c/temporal_filter.h"
#include "xrds/c/upscaler.h"

#endif
