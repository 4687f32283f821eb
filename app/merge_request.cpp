#include "app/merge_request.h"

#include <cmath>
#include <cstdio>

#include "app/number_pair.h"
#include "image/layers/cycles_text.h"
#include "image/leading_number.h"

namespace xrds {
std::optional<double> samplesOf(const FrameLayer& layer) {
  const ExrAttributes& attributes = layer.part.attributes;
  std::optional<double> samples = attributes.number("samplesPerPixel");
  if (const auto text = cyclesText(attributes, layer.name, "samples")) {
    const auto number = leadingNumber(text->data(), text->data() + text->size());
    if (number) samples = number->value;
  }
  return samples && *samples > 0 && std::isfinite(*samples) ? samples : std::nullopt;
}

std::optional<RenderSamples> samplesOf(const FrameLayer& low, const FrameLayer& full) {
  const std::optional<double> lowSamples = samplesOf(low), fullSamples = samplesOf(full);
  if (!lowSamples || !fullSamples) return {};
  return RenderSamples{*lowSamples, *fullSamples};
}

MergeRequest mergeRequest(const std::string& auxColour, const std::string& samples, AovRequest& layers) {
  if (auxColour != "auto" && auxColour != "never") layers.names[AovRole::kFullColor] = auxColour;
  MergeRequest request{.never = auxColour == "never", .ofAllModels = true};
  if (const auto pair = parsePair(samples)) request.samples = {pair->first, pair->second};
  return request;
}

std::string describe(const MergedColour& merged) {
  char share[64], samples[64] = "";
  std::snprintf(share, sizeof share, "%.0f %%", 100 * merged.share);
  if (merged.samples)
    std::snprintf(samples, sizeof samples, "%g and %g samples a pixel, ", merged.samples->low, merged.samples->full);
  const char* source = merged.source == "given"      ? "as given"
                       : merged.source == "metadata" ? "as the files say"
                                                     : "estimated from the noise of both";
  return "The colour is merged with '" + merged.layer + "' of the full-resolution render, which makes " + share +
         " of it (" + samples + source + ").";
}

}  // namespace xrds
