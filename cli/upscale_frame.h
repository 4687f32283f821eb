#pragma once

#include <string>
#include <vector>

#include "cli/upscale_input.h"
#include "cli/upscale_report.h"
#include "image/exr/write.h"

namespace xrds {

/// Finds the fastest kernels of the device for the frame, where --tune asks for it. Before anything else, and not while
/// an interrupt ends the process at once: what is being tried would be struck off. Throws Error, and Failure when
/// interrupted.
void tuneFirst(Device& device, const UpscaleInput& input, const UpscaleOptions& options);

/// One frame through an upscaler of its size and the model. Throws Error, and Failure when interrupted.
Upscaled upscaledBy(Upscaler& upscaler, const Model& model, const Frame& frame, const Upscaler::Progress& progress);

/// What is to be said of a result: pixels that the network could not make, layers that do not add up.
std::vector<std::string> warningsOf(const Upscaled& result, const Frame& frame, const UpscaleOptions& options);

/// What the file of a result says beside its pixels. Throws Error if the windows do not fit in 32 bits.
ExrOutput outputOf(const UpscaleOptions& options, const OpenedModel& opened, const Frame& frame, float exposure);

/// Writes the colour, with alpha if it has four channels, and what layers the frame has. Throws Error.
void writePicture(const std::filesystem::path& path, const Frame& frame, const Image& image,
                  const UpscaledLayers& layers, const ExrOutput& output);

}  // namespace xrds
