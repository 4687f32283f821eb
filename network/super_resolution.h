#pragma once

#include <string>
#include <vector>

#include "network/image_pipeline.h"
#include "network/layers.h"

namespace xrds {

/// What the super-resolution networks that the paper compares with (EDSR, RCAN, SwinIR, MSSPL) share: their fields, the
/// inputs, and the way up by pixel shuffles.

/// Reads the fields scale, channels and transfer, and leaves out what these networks do not have. Throws Error.
void parseSuperResolution(const Metadata& metadata, NetworkConfig& config);
void describeSuperResolution(const NetworkConfig& config, Metadata& metadata);

/// The field range, by which networks for photographs multiply the colour.
void parseRange(const Metadata& metadata, NetworkConfig& config);
void describeRange(const NetworkConfig& config, Metadata& metadata);

/// The inputs of the graph, as the network sees them, and the output, without nodes yet.
Prepared prepareFrame(Layers& layers, FrameShape frame);

/// range (x - mean) of the colour [h, w, 4]; the mean [3] is a parameter of the model file.
TensorView normalizedColour(Layers& layers, const TensorView& x);

/// Divides the convolution `name` of that many inputs by the range and adds the mean to it: layers made from here on
/// give y / range + mean of its result y. Its channels are an equal number for each of the three colours.
void denormalize(Layers& layers, const std::string& name, uint32_t inputs, uint32_t outputs);

/// The picture of the features u: y = pixel_shuffle(conv3x3(y)) for each of the convolutions, with so many channels
/// behind it (0: those of u), then the convolution `output` to the three colours, decoded; in a sweep over rows.
void upscale(Layers& layers, const TensorView& u, const Prepared& prepared, const std::vector<std::string>& doublings,
             const std::string& output, uint32_t channels = 0);

/// The same of EDSR and RCAN: of head + conv3x3(f) with the convolution `last`, by those of "tail.0." and "tail.1".
void upscaleFromTrunk(Layers& layers, const std::string& last, const TensorView& f, const TensorView& head,
                      const Prepared& prepared);

/// The picture of pixel_shuffle(conv3x3(u), scale) with the convolution `name`, by doublings with the same result.
void upscaleDirectly(Layers& layers, const TensorView& u, const Prepared& prepared, const std::string& name);

/// "PREFIX0", "PREFIX2", ...: the convolutions in an nn.Sequential with a pixel shuffle behind each.
std::vector<std::string> doublingNames(const NetworkConfig& config, const std::string& prefix);

}  // namespace xrds
