#pragma once

#include <string>

#include "image/layers/aov.h"
#include "xrds/xrds.hpp"

namespace CLI {
class App;
}

namespace xrds {

/// What `xrds upscale` was asked for.
struct UpscaleOptions {
  std::string color, aux, output, model, device, reference, preview, sideBySide, json,
      precision = kFp32, exposure = "auto", memory, tiles = "bounded", skip = "off", skipMap, auxColour = "auto",
      samples, tune = "auto", lights, denoiseBy = "auto", denoisers;
  AovRequest layers;
  uint32_t ensemble = 1;
  bool half = false, profile = false, check = false, quiet = false, wrap = false;
  bool denoiseFirst = false, cleanGuides = false;
  // Of sequences.
  std::string frames, log, devices, motion;
  uint32_t jobsPerDevice = 1;
  std::optional<uint32_t> temporalRadius;  // none: what suits a frame
  bool skipExisting = false, keepUnchanged = false, temporal = false;

  Upscaler::Options upscaler() const;
};

/// Declares the options on the command.
void addUpscaleOptions(CLI::App& verb, UpscaleOptions& options);

/// Those of sequences, of other commands too.
void addSequenceOptions(CLI::App& verb, UpscaleOptions& options);

/// Asks before a long computation for everything about the files to write that can be known to fail. Throws Failure.
void requireOutputs(const UpscaleOptions& options);

}  // namespace xrds
