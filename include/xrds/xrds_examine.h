/* Whether a device computes what it should, and which kernels are the fastest on it. Beside xrds.h, whose head tells of
 * results, handles, threads and structures. Strings and lists in what a callback hears are valid as long as the call.
 */
#ifndef XRDS_XRDS_EXAMINE_H
#define XRDS_XRDS_EXAMINE_H

#include "xrds/c/examination.h"
#include "xrds/c/stress.h"
#include "xrds/c/tuning.h"

#endif
