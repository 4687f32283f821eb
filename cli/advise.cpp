#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>

#include "advice/scene_features.h"
#include "app/failing_with.h"
#include "app/frame.h"
#include "app/frame_files.h"
#include "app/layer_options.h"
#include "app/models.h"
#include "app/number_pair.h"
#include "app/number_range.h"
#include "cli/advise_report.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/device_choice.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/step_seconds.h"
#include "cli/warnings.h"
#include "image/image_view.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

constexpr const char* kWaysFile = "ways.json";

struct AdviseOptions {
  std::string low, full, samples, seconds, device, json, ways;
  AovRequest layers;
  std::optional<double> guideSeconds, within, reach;
  bool quiet = false, sceneOnly = false;
};

// The two renders as they are, and the colour of the full-resolution one as its third auxiliary image.
Frame readRenders(AdviseOptions& options) {
  const FrameFiles files = sortPair(pathOf(options.low), pathOf(options.full));
  options.low = files.colour.string();
  options.full = files.auxiliary.string();
  const std::vector<std::string> inputs{std::string(kAlbedo.name), std::string(kNormal.name),
                                        std::string(kFullColour.name)};
  Frame frame(pathOf(options.low), pathOf(options.full), options.layers, inputs, {.never = true});
  if (frame.scale() < 2) throw Error("Both renders have the same size: one must be of a lower resolution.");
  frame.load();
  return frame;
}

// Guides that were rendered without light, say, tell nothing of the noise.
void warnOfOtherLight(const Frame& frame) {
  const double difference = colourDifference(viewOf(frame.colour()), viewOf(*frame.imageOf(kFullColour.name)));
  if (difference > kMostColourDifference)
    printWarnings({"The colours of the two renders differ by " + std::to_string(std::lround(100 * difference)) +
                   " %: they are of other light, and what is told of noise and plans is wrong; render both alike."});
}

RenderSamples samplesAskedFor(const AdviseOptions& options, const Frame& frame) {
  if (const auto given = parsePair(options.samples)) return {given->first, given->second};
  if (const auto told = samplesOf(frame.colourLayer(), frame.fullColourLayer())) return *told;
  throw Failure{ExitCode::usage, "The files do not say how many samples their renders have: --samples LOW,FULL does."};
}

RenderCost costOf(const AdviseOptions& options, const Frame& frame, RenderSamples samples) {
  std::optional<std::pair<double, double>> seconds = parsePair(options.seconds);
  if (!seconds) {
    const FrameLayer ofLow = frame.colourLayer(), ofFull = frame.fullColourLayer();
    const auto low = secondsOf(ofLow.part, ofLow.name), full = secondsOf(ofFull.part, ofFull.name);
    if (!low || !full)
      throw Failure{ExitCode::usage,
                    "The files do not say how long their renders took: --render-seconds LOW,FULL does."};
    seconds = {*low, *full};
  }
  const Image& colour = frame.colour();
  return renderCost({seconds->first, samples.low, colour.pixelCount()},
                    {seconds->second, samples.full, frame.auxiliary().front().pixelCount()});
}

std::filesystem::path waysFile(const AdviseOptions& options) {
  if (!options.ways.empty()) return pathOf(options.ways);
  if (std::filesystem::path file = inModelFolders(kWaysFile); !file.empty()) return file;
  throw Error(std::string("No folder of models holds ") + kWaysFile + ": install xrds again, or name one with --ways.");
}

// A frame that is no multiple of a scale cannot be rendered for it.
void leaveUnfitOut(std::vector<Way>& ways, Advice& advice) {
  std::erase_if(ways, [&](const Way& way) {
    const bool fits = advice.width % way.scale == 0 && advice.height % way.scale == 0;
    if (!fits) advice.unfitScales.insert(way.scale);
    return !fits;
  });
}

void addPlans(const AdviseOptions& options, const std::vector<Way>& ways, Device& device, Advice& advice) {
  const size_t pixels = static_cast<size_t>(advice.width) * static_cast<size_t>(advice.height);
  advice.device = device.description().name;
  advice.steps = measureSteps(device, ways, pixels);
  advice.steps.freeGuides = options.guideSeconds;
  const std::vector<Plan> plans = plansOf(advice.scene, ways, *advice.cost, advice.steps, pixels);
  advice.plans = worthwhile(plans);
  if (options.within) advice.chosen = bestWithin(plans, *options.within);
  if (options.reach) advice.chosen = quickestReaching(plans, *options.reach);
}

void requireChosen(const AdviseOptions& options, const Advice& advice) {
  if (advice.cost && advice.plans.empty())
    throw Failure{ExitCode::differs,
                  "There is no plan: of the ways that can be gone here none was measured at the noise of this scene."};
  if (advice.chosen || (!options.within && !options.reach)) return;
  char text[96];
  std::snprintf(text, sizeof text,
                options.within ? "No plan takes at most %g s." : "No plan is predicted to reach %g dB.",
                options.within ? *options.within : *options.reach);
  throw Failure{ExitCode::differs, text};
}

void run(AdviseOptions options) {
  requireOutput(options.json, ".json", "--json");
  const Frame frame = failingWith(ExitCode::input, [&] { return readRenders(options); });
  printWarnings(frame.warnings());
  warnOfOtherLight(frame);
  Advice advice{.low = options.low, .full = options.full};
  const auto& auxiliary = frame.auxiliary();
  advice.width = auxiliary[0].width;
  advice.height = auxiliary[0].height;
  advice.samples = samplesAskedFor(options, frame);
  advice.scene = failingWith(ExitCode::input, [&] {
    return sceneFeatures({frame.colour(), auxiliary[2], auxiliary[0], auxiliary[1], advice.samples});
  });
  if (!options.sceneOnly) {
    advice.cost = failingWith(ExitCode::usage, [&] { return costOf(options, frame, advice.samples); });
    std::vector<Way> ways = failingWith(ExitCode::model, [&] { return readWays(waysFile(options)); });
    leaveUnfitOut(ways, advice);
    onDevice(options.device, options.quiet, [&](Device& device) { addPlans(options, ways, device, advice); });
  }
  if (!options.quiet) std::fputs(plainText(advice).c_str(), stdout);
  if (!options.json.empty()) failingWith(ExitCode::output, [&] { writeText(options.json, jsonText(advice)); });
  requireChosen(options, advice);
}

}  // namespace

void addAdvise(CLI::App& app) {
  const auto options = std::make_shared<AdviseOptions>();
  CLI::App* verb = app.add_subcommand("advise", "Tell from two cheap renders which render to make");
  verb->add_option("LOW", options->low,
                   "EXR file, the frame at low resolution with few samples; this and FULL in any order")
      ->required();
  verb->add_option("FULL", options->full,
                   "EXR file, the frame at full resolution with one sample: colour, albedo, normal")
      ->required();
  const CLI::Validator pair(validPair, "LOW,FULL");
  verb->add_option("--samples", options->samples, "Samples a pixel of the two renders (default: the files' metadata)")
      ->check(pair);
  verb->add_option("--render-seconds", options->seconds, "What the two renders took (default: the files' metadata)")
      ->check(pair);
  verb->add_option("--guide-seconds", options->guideSeconds,
                   "What clean albedo and normal of the frame take, made by cheaper means than paths; 0 for\n"
                   "rasterized ones (default: only those of path-traced renders are considered)")
      ->check(numberIn(0, 1e9))
      ->type_name("SECONDS");
  CLI::Option* within = verb->add_option("--within", options->within, "Advise the best plan that takes at most so long")
                            ->check(numberIn(0.001, 1e9))
                            ->type_name("SECONDS");
  verb->add_option("--reach", options->reach, "Advise the quickest plan that is predicted to reach this PSNR")
      ->check(numberIn(0.001, 1e9))
      ->type_name("DB")
      ->excludes(within);
  verb->add_flag("--scene-only", options->sceneOnly, "Tell what the renders say of the scene, and no plans");
  verb->add_option("--ways", options->ways, "File of ways and what their errors depend on (default: the shipped one)")
      ->type_name("JSON");
  addLayerOptions(*verb, options->layers);
  verb->add_option("--aux-colour", options->layers.names[AovRole::kFullColor],
                   "Layer to take as the colour of the full-resolution render")
      ->type_name("LAYER");
  addDevice(*verb, options->device);
  addReportFile(*verb, options->json);
  addQuiet(*verb, options->quiet);
  verb->footer(
      "Times are those of the two renders, extended to other samples, and of networks and denoiser on this device.\n"
      "Errors are predicted from the noise and the detail of the scene; bench/advice.md tells how well.\n\n"
      "Examples:\n"
      "  xrds advise low_4spp.exr full_1spp.exr --within 60\n"
      "  xrds advise low.exr full.exr --samples 4,1 --render-seconds 3.1,9.5 --reach 35 --json advice.json");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
