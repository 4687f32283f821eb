#include "cli/upscale_input.h"

#include <algorithm>

#include "app/constant_input.h"
#include "app/failing_with.h"
#include "app/frame_files.h"
#include "app/models.h"
#include "app/skip_bound.h"
#include "cli/first_denoiser.h"
#include "cli/warnings.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

// How the colour alone can be upscaled, where it can.
std::string colourAloneHint(const UpscaleOptions& options) {
  try {
    const Frame frame(pathOf(options.color), {}, options.layers, {});
    return "\n  or, of the colour alone: --model " + defaultModel(frame.scale(), frame.inputs()).stem().string();
  } catch (const Error&) {
    return "";
  }
}

// Whether there is a full-resolution colour that may be merged.
bool mayMerge(const UpscaleOptions& options) {
  AovRequest layers = options.layers;
  return !mergeRequest(options.auxColour, options.samples, layers).never &&
         hasFullColour(pathOf(options.color), pathOf(options.aux), layers);
}

// The auxiliary images that the files have beside the albedo, of those that a default model may take.
std::vector<std::string> inputsThere(const UpscaleOptions& options, const ExrFile& file) {
  std::vector<std::string> inputs{std::string(kAlbedo.name)};
  if (!options.layers.nameOf(AovRole::kNormal).empty() || hasAov(file, AovRole::kNormal))
    inputs.emplace_back(kNormal.name);
  if (mayMerge(options)) inputs.emplace_back(kFullColour.name);
  return inputs;
}

// Samples a pixel of the low-resolution colour by which the model is chosen, where they are known. With --skip they do
// not count: the models of few samples cannot skip windows.
std::optional<double> lowSamples(const UpscaleOptions& options, const Frame& frame) {
  if (parseSkip(options.skip) > 0) return {};
  return frame.lowSamples();
}

fs::path modelFile(const UpscaleOptions& options) {
  if (!options.model.empty()) return failingWith(ExitCode::model, [&] { return resolveModel(options.model); });
  const ExrFile file = failingWith(
      ExitCode::input, [&] { return readExrHeader(pathOf(options.aux.empty() ? options.color : options.aux)); });
  int scale = 0;
  std::optional<double> samples;
  try {
    const Frame frame = failingWith(ExitCode::input, [&] {
      AovRequest layers = options.layers;
      const MergeRequest merge = mergeRequest(options.auxColour, options.samples, layers);
      return Frame(pathOf(options.color), pathOf(options.aux), layers, {std::string(kAlbedo.name)}, merge);
    });
    scale = frame.scale();
    samples = lowSamples(options, frame);
  } catch (Failure& failure) {
    if (options.layers.nameOf(AovRole::kAlbedo).empty() && !hasAov(file, AovRole::kAlbedo))
      failure.message += colourAloneHint(options);
    throw;
  }
  const std::vector<std::string> inputs = inputsThere(options, file);
  const bool hasNormal = std::find(inputs.begin(), inputs.end(), kNormal.name) != inputs.end();
  const fs::path model = failingWith(ExitCode::model, [&] { return defaultModel(scale, inputs, samples); });
  if (!hasNormal && model.stem().string() != defaultModelName(scale))
    printWarnings({"'" + file.path.string() + "' has no normal; taking model " + model.stem().string() + "."});
  return model;
}

OpenedModel openModel(const fs::path& file) {
  return {file, failingWith(ExitCode::model, [&] { return Model(file); })};
}

OpenedModel openModel(const UpscaleOptions& options) {
  OpenedModel opened = openModel(modelFile(options));
  failingWith(ExitCode::model, [&] { requireKnownInputs(opened.model, opened.name()); });
  return opened;
}

Frame openFrame(const UpscaleOptions& options, const OpenedModel& opened) {
  Frame frame = failingWith(ExitCode::input, [&] {
    AovRequest layers = options.layers;
    const MergeRequest merge = mergeRequest(options.auxColour, options.samples, layers);
    return Frame(pathOf(options.color), pathOf(options.aux), layers, opened.model.auxiliaryInputs(), merge);
  });
  const int scale = static_cast<int>(opened.model.scale());
  if (frame.scale() != 0 && frame.scale() != scale)
    throw Failure{ExitCode::model, "The auxiliary images have " + std::to_string(frame.scale()) +
                                       " times the colour's size, but model '" + opened.name() + "' upscales by " +
                                       std::to_string(scale) + ": choose another with --model."};
  failingWith(ExitCode::input, [&] {
    (void)frame.output(scale);  // throws if the windows do not fit
    frame.load();
  });
  return frame;
}

void requireSkippable(const UpscaleOptions& options, const OpenedModel& opened) {
  if (parseSkip(options.skip) == 0) return;
  if (const std::string why = opened.model.whyNeverSkipped(); !why.empty())
    throw Failure{ExitCode::model, "--skip is refused: model '" + opened.name() + "' " + why + "."};
}

// Another model, and the frame as that takes it.
void reopen(const UpscaleOptions& options, const fs::path& file, OpenedModel& opened, Frame& frame) {
  opened = openModel(file);
  frame = openFrame(options, opened);
}

// The model that does without a constant input is taken, where one is shipped.
void leaveConstantsOut(const UpscaleOptions& options, const std::function<bool(const OpenedModel&)>& isAlwaysSo,
                       OpenedModel& opened, Frame& frame) {
  const std::string input = constantInput(frame.inputs(), frame.auxiliary());
  if (input.empty() || (isAlwaysSo && !isAlwaysSo(opened))) return;
  const fs::path file = modelWithout(input, static_cast<int>(opened.model.scale()));
  if (file.empty()) return;
  reopen(options, file, opened, frame);
  printWarnings({tellConstant(input, opened.name())});
}

// The colour of the full-resolution render may be of other light, and models that take it cannot skip windows: then one
// that does without it is taken.
void leaveColourOut(const UpscaleOptions& options, OpenedModel& opened, Frame& frame) {
  const bool skips = parseSkip(options.skip) > 0 && !opened.model.whyNeverSkipped().empty();
  if ((frame.merged() && !skips) || !takes(opened.model, kFullColour)) return;
  const auto scale = static_cast<int>(opened.model.scale());
  const fs::path file = failingWith(ExitCode::model, [&] {
    return defaultModel(scale, {std::string(kAlbedo.name), std::string(kNormal.name)}, lowSamples(options, frame));
  });
  reopen(options, file, opened, frame);
}

// Layers that were named for what the model does not take. Merging frames may take them.
void warnOfUnused(const UpscaleOptions& options, const OpenedModel& opened, Frame& frame) {
  if (options.temporal) return;
  for (const AuxiliaryInput& input : kAuxiliaryInputs) {
    const auto named = options.layers.names.find(roleOf(input.name));
    if (named == options.layers.names.end() || named->second.empty() || takes(opened.model, input)) continue;
    const std::string name(input.name);
    if (name != kFullColour.name)
      frame.warn("--" + name + " is not used: model " + opened.name() + " does not take it.");
  }
}

// What is left to do before the network, once the model is certain.
void prepare(const UpscaleOptions& options, const OpenedModel& opened, Frame& frame) {
  failingWith(ExitCode::input, [&] { (void)inputsOf(opened.model, frame); });  // throws if one is not there
  warnOfUnused(options, opened, frame);
  requireSkippable(options, opened);
  if (const LayerRequest request = layerRequest(options.lights); request.any())
    failingWith(ExitCode::input, [&] { frame.loadLayers(request, opened.model.scale()); });
  if (options.denoiseFirst && !denoisesOnDevice(options, frame)) denoiseByLibrary(options, frame);
}

}  // namespace

void sortInputs(UpscaleOptions& options) {
  if (options.aux.empty()) return;
  const FrameFiles files =
      failingWith(ExitCode::input, [&] { return sortPair(pathOf(options.color), pathOf(options.aux)); });
  options.color = files.colour.string();
  options.aux = files.auxiliary.string();
}

void requireLayersPossible(const UpscaleOptions& options) {
  if (options.lights.empty()) return;
  constexpr const char* kWhy = "--layers needs every pixel of each frame: it cannot go with ";
  if (parseSkip(options.skip) > 0) throw Failure{ExitCode::usage, std::string(kWhy) + "--skip."};
  if (options.keepUnchanged) throw Failure{ExitCode::usage, std::string(kWhy) + "--keep-unchanged."};
}

bool hasConstants(const UpscaleOptions& options, const OpenedModel& opened) {
  const Frame frame = openFrame(options, opened);
  return !constantInput(frame.inputs(), frame.auxiliary()).empty();
}

UpscaleInput openInput(const UpscaleOptions& options, const std::function<bool(const OpenedModel&)>& isAlwaysSo) {
  OpenedModel opened = openModel(options);
  Frame frame = openFrame(options, opened);
  if (options.model.empty()) {
    leaveColourOut(options, opened, frame);
    leaveConstantsOut(options, isAlwaysSo, opened, frame);
  }
  prepare(options, opened, frame);
  return {std::move(opened), std::move(frame)};
}

Frame readFrame(const UpscaleOptions& options, const OpenedModel& opened) {
  Frame frame = openFrame(options, opened);
  prepare(options, opened, frame);
  return frame;
}

}  // namespace xrds
