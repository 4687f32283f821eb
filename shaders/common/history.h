// Frames of a sequence as the operators of history take them: three quads a pixel, (radiance, count), (albedo,
// nearness) and (normal, 0). The count says how many frames the radiance is the mean of; the nearness is one over the
// distance, 0 of what has none.
#ifndef XRDS_SHADERS_COMMON_HISTORY_H
#define XRDS_SHADERS_COMMON_HISTORY_H
#include "shaders/common/image.h"
#include "shaders/common/transfer.h"

XRDS_SHARED_BEGIN
const int kHistoryFrame = 12;          // channels of a frame
const int kHistoryWarped = 16;         // of what warp_history makes
const float kHistoryNearest = 1e-30f;  // of nearnesses that are compared: those below are as far as the background
const float kHistoryAlbedo = 0.2f;     // differences that make a weight 1 / e, of the mean of 3 x 3 pixels
const float kHistoryNormal = 0.35f;
const float kHistoryNearness = 0.1f;  // relative
const float kHistoryBias = 6.0f;      // by which the bias of a pixel exceeds that of the mean around, at worst
const float kHistoryNoise = 1e-6f;    // variance that is taken to be there always
const float kHistoryLuck = 4.0f;      // most variances of a mean that its square may be by chance
const float kHistoryCubic = -0.5f;    // of the kernel that frames are read by: Catmull and Rom's
const float kHistoryLeast = 1e-9f;    // what sums of weights are at least
XRDS_SHARED_END
#endif
