#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "app/frame.h"
#include "cli/upscale_options.h"
#include "xrds/xrds.hpp"

namespace xrds {

/// The model of a run and the file it came from.
struct OpenedModel {
  std::filesystem::path file;
  Model model;
  std::string name() const { return file.stem().string(); }
};

/// What a run reads: the frame, and the model that was asked for or suits its layers.
struct UpscaleInput {
  OpenedModel opened;
  Frame frame;
};

/// Puts COLOR and AUX in their order, whichever they were given in. Throws Failure if one cannot be read.
void sortInputs(UpscaleOptions& options);

/// Throws Failure where --layers is given beside options with which no layers can be made.
void requireLayersPossible(const UpscaleOptions& options);

/// Opens model and frame, and reads the frame, with --denoise-first without its noise unless that takes the device
/// (denoisesOnDevice()). Warnings about the choice of the model are printed. An albedo or a normal that is the same
/// everywhere is left out, unless `isAlwaysSo` says that it is not so in other frames. Throws Failure.
UpscaleInput openInput(const UpscaleOptions& options, const std::function<bool(const OpenedModel&)>& isAlwaysSo = {});

/// Whether the albedo or the normal of a frame is the same everywhere. Throws Failure.
bool hasConstants(const UpscaleOptions& options, const OpenedModel& opened);

/// The frame as openInput() reads it, for a model that is there already. Throws Failure.
Frame readFrame(const UpscaleOptions& options, const OpenedModel& opened);

}  // namespace xrds
