#pragma once

#include <optional>
#include <string>

#include "image/layers/aov.h"
#include "xrds/merged_colour.h"

namespace xrds {

/// A layer of a frame by its name, and the part that holds it.
struct FrameLayer {
  const ExrPart& part;
  const std::string& name;
};

/// What becomes of the colour of the full-resolution render, where there is one.
struct MergeRequest {
  bool never = false;
  bool ofAllModels = false;              // of those that take no auxiliary images, too
  std::optional<RenderSamples> samples;  // of the two renders, if the user gives them
};

/// The colour that a frame merged into its own.
struct MergedColour {
  std::string layer;
  double share = 0;                      // of the full-resolution render's
  std::optional<RenderSamples> samples;  // where they are known
  std::string source;                    // of the share: "given", "metadata" or "noise"
};

/// What was merged and how its share is known, as a sentence.
std::string describe(const MergedColour& merged);

/// What --aux-colour and --samples ask for: "auto", "never" or a layer's name, which goes into `layers`; "LOW,HIGH" or
/// nothing.
MergeRequest mergeRequest(const std::string& auxColour, const std::string& samples, AovRequest& layers);

/// The samples a pixel of a layer that its file's metadata give: Cycles' "cycles.VIEWLAYER.samples", pbrt's
/// "samplesPerPixel".
std::optional<double> samplesOf(const FrameLayer& layer);
/// The same of two files; nothing unless both tell.
std::optional<RenderSamples> samplesOf(const FrameLayer& low, const FrameLayer& full);

}  // namespace xrds
