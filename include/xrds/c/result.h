/* What functions return, and the library's version. The head of xrds.h tells of both. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_C_RESULT_H
#define XRDS_C_RESULT_H

#include <stddef.h>
#include <stdint.h>

#include "xrds/export.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum XrdsResult {
  XRDS_OK = 0,
  XRDS_CANCELLED = 1,            /* a callback returned 0 */
  XRDS_ERROR_ARGUMENT = -1,      /* what was given cannot be: a null pointer, a size, a handle, an option */
  XRDS_ERROR_FAILED = -2,        /* the world: a file, a driver, no device */
  XRDS_ERROR_OUT_OF_MEMORY = -3, /* of the device, or what it may take, or the host; less may fit */
  XRDS_ERROR_DEVICE_LOST = -4,   /* what was made on the device is of no more use; it may be opened again */
  XRDS_ERROR_BUSY = -5,          /* the upscaler is in use on another thread */
  XRDS_ERROR_INTERNAL = -6       /* an error of the library: please report the message */
} XrdsResult;

/* The version of the library: 0 for the first, 1 for the second and 2 for the third number of "0.1.0". Any may be
 * NULL. */
XRDS_API void xrdsGetVersion(uint32_t* major, uint32_t* minor, uint32_t* patch);

/* What the last failed call of this thread has to say; "" if none failed. Valid until the next call of the thread. */
XRDS_API const char* xrdsGetMessage(void);

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
