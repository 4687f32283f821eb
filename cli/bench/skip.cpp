#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>

#include "app/failing_with.h"
#include "app/models.h"
#include "app/skip_bound.h"
#include "cli/bench/skip_report.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "image/metrics/metrics.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

struct BenchSkipOptions {
  std::string folder, model, device, json, markdown, skip = "safe", precision = kFp32;
  std::optional<int> scale;  // the model's
  int runs = 5, colour = 64, aux = 16;
  bool cpuTime = false, quiet = false;

  Upscaler::Options upscaler(float bound) const { return {.fp16 = precision == kFp16, .skip = {.bound = bound}}; }
};

// Wall clock, or what all threads of the process have taken of the cores: on a busy machine the CPU devices' measure.
double secondsNow(bool cpuTime) {
  if (cpuTime) return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

LargestChange largestChange(const Image& full, const Image& result, const SkipMap& map, float exposure) {
  LargestChange largest;
  const int side = static_cast<int>(map.side);
  const auto encoded = [&](float radiance) { return std::log1p(exposure * std::max(radiance, 0.F)); };
  for (size_t i = 0; i < map.windows.size(); ++i) {
    const int top = static_cast<int>(i / map.columns) * side, left = static_cast<int>(i % map.columns) * side;
    const int bottom = std::min(top + side, full.height), right = std::min(left + side, full.width);
    double sum = 0;
    for (int y = top; y < bottom; ++y)
      for (size_t at = full.index(left, y); at < full.index(left, y) + size_t(3) * (right - left); ++at)
        sum += std::pow(encoded(result.pixels[at]) - encoded(full.pixels[at]), 2);
    const double change = std::sqrt(sum / (3.0 * (bottom - top) * (right - left)));
    double& most = map.windows[i] == SkipMap::Window::interpolated ? largest.interpolated : largest.computed;
    most = std::max(most, change);
  }
  return largest;
}

// Both are run once before, so that everything is compiled and planned, then in pairs, the other one first each time.
SkipMeasurement measureScene(Device& device, const Model& model, const SceneFiles& files, const Scene& scene,
                             const BenchSkipOptions& options) {
  const Frame& frame = scene.frame;
  Upscaler full(device, model, frame.width(), frame.height(), options.upscaler(0));
  Upscaler skipping(device, model, frame.width(), frame.height(), options.upscaler(parseSkip(options.skip)));
  const auto auxiliary = inputsOf(model, frame);
  const auto seconds = [&](Upscaler& upscaler, Image& result) {
    const double start = secondsNow(options.cpuTime);
    upscaler.run(viewOf(frame.colour()), auxiliary, result.pixels, [](double) { return !interrupted(); });
    stopIfInterrupted();
    return secondsNow(options.cpuTime) - start;
  };
  Image off(scene.reference.width, scene.reference.height, 3), on = off;
  seconds(full, off);
  seconds(skipping, on);
  SkipMeasurement made{files.name, skipping.skipMap()};
  for (int run = 0; run < options.runs; ++run) {
    if (run % 2 == 0) made.secondsOff.push_back(seconds(full, off));
    made.seconds.push_back(seconds(skipping, on));
    if (run % 2 != 0) made.secondsOff.push_back(seconds(full, off));
  }
  made.psnrOff = psnr(off, scene.reference);
  made.psnr = psnr(on, scene.reference);
  made.change = largestChange(off, on, made.map, full.exposure());
  return made;
}

void checkOptions(const BenchSkipOptions& options) {
  if (parseSkip(options.skip) == 0)
    throw Failure{ExitCode::usage, "--skip off leaves nothing to compare with full runs: expected safe or a bound."};
  requireOutput(options.json, ".json", "--json");
  requireOutput(options.markdown, ".md", "--markdown");
}

void run(const BenchSkipOptions& options) {
  checkOptions(options);
  const std::string name = options.model.empty() ? defaultModelName(options.scale.value_or(4)) : options.model;
  const Model model = failingWith(ExitCode::model, [&] { return Model(resolveModel(name)); });
  if (options.scale.value_or(model.scale()) != static_cast<int>(model.scale()))
    throw Failure{ExitCode::usage, "The model '" + name + "' has scale " + std::to_string(model.scale()) +
                                       ": leave --scale out, or --model."};
  const QualitySetting setting = settingFor(model, options.colour, options.aux);
  const SceneList list = failingWith(ExitCode::input, [&] { return findScenes(pathOf(options.folder), setting, {}); });
  Device device = failingWith(ExitCode::device, [&] { return Device({.select = options.device}); });
  SkipReport report{{options.folder, name, model.hash(), options.precision, setting, device.description()},
                    options.skip,
                    options.runs,
                    options.cpuTime};
  for (const SceneFiles& files : list.scenes) {
    const Scene scene = failingWith(ExitCode::input, [&] { return loadScene(files, setting); });
    report.scenes.push_back(
        failingWith(ExitCode::device, [&] { return measureScene(device, model, files, scene, options); }));
  }
  if (!options.quiet) std::fputs(plainText(report).c_str(), stdout);
  failingWith(ExitCode::output, [&] {
    if (!options.json.empty()) writeText(options.json, jsonText(report));
    if (!options.markdown.empty()) writeText(options.markdown, markdownText(report));
  });
}

}  // namespace

void addBenchSkip(CLI::App& group) {
  const auto options = std::make_shared<BenchSkipOptions>();
  CLI::App* verb = group.add_subcommand("skip", "Compare runs that skip windows with full ones on a folder of scenes");
  verb->add_option("FOLDER", options->folder, "Folder of scenes, as xrds bench quality reads it")->required();
  verb->add_option("--model", options->model, "A shipped model's name or a .safetensors file")->type_name("MODEL");
  verb->add_option("--skip", options->skip, "As in xrds upscale, but off")
      ->check(CLI::Validator(validSkip, "safe|N"))
      ->capture_default_str();
  verb->add_option("--scale", options->scale, "Of the colour's render (default: the model's, else 4)")
      ->check(CLI::IsMember({1, 2, 4, 8, 16}));
  addSceneSamples(*verb, options->colour, options->aux);
  verb->add_option("--runs", options->runs, "Pairs of runs, of which the median is taken")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_flag("--cpu-time", options->cpuTime,
                 "Time what the process takes of the cores: for CPU devices, busy machines");
  addPrecision(*verb, options->precision);
  addDevice(*verb, options->device);
  addReportFile(*verb, options->json);
  verb->add_option("--markdown", options->markdown, "File to write with the table")->type_name("MD");
  addQuiet(*verb, options->quiet);
  verb->footer(
      "Each scene is upscaled in full and with --skip, in pairs, after one run of each. skipped: share of the windows\n"
      "that were interpolated; work: pixels computed, surroundings included, over all; the last two columns: the\n"
      "largest change of a window, root mean square of log(1 + exposure radiance), among those skipped and the "
      "others.");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
