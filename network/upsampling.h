#pragma once

#include "network/image_pipeline.h"
#include "network/layers.h"

namespace xrds {

/// From the features u [h, w, C] of the low-resolution branch to graph.output, in bands of the high-resolution image:
/// U = leaky_relu(conv3x3(u)); n times U = pixel_shuffle_2(conv3x3(U)); the output convolution of U, or of [U, h] with
/// h = H_N; then the base image and the decoding of metrics.md. A model without network has no u, one without an
/// auxiliary skip no h. Sets graph.network if all of the raw output is there at once.
void upsample(Layers& layers, TensorView u, TensorView h, const Prepared& prepared, TensorView prefiltered = {});

}  // namespace xrds
