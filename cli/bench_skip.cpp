#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>

#include "app/failing_with.h"
#include "app/models.h"
#include "app/skip_bound.h"
#include "cli/commands.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/quality_scenes.h"
#include "cli/quiet.h"
#include "cli/table.h"
#include "image/metrics.h"

namespace xrds {
namespace {

struct BenchSkipOptions {
  std::string folder, model, device, markdown, skip = "safe", precision = kFp32;
  int scale = 4, runs = 5, colour = 64, aux = 16;
  bool cpuTime = false, quiet = false;

  Upscaler::Options upscaler(float bound) const { return {.fp16 = precision == kFp16, .skip = {.bound = bound}}; }
};

/// The largest change of a window, root mean square of log(1 + exposure radiance).
struct LargestChange {
  double interpolated = 0, computed = 0;
};

/// One scene without and with skipping.
struct SkipMeasurement {
  std::string scene;
  SkipMap map;
  std::vector<double> secondsOff, seconds;  // of each pair of runs
  double psnrOff = 0, psnr = 0;
  LargestChange change;
};

// Of the sorted values, interpolated.
double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<size_t>(at);
  const double above = values[std::min(below + 1, values.size() - 1)];
  return values[below] + (at - static_cast<double>(below)) * (above - values[below]);
}
double median(const std::vector<double>& values) { return quantile(values, 0.5); }

// The first of each pair over the second.
std::vector<double> ratios(const std::vector<double>& first, const std::vector<double>& second) {
  std::vector<double> result;
  for (size_t i = 0; i < first.size(); ++i) result.push_back(first[i] / second[i]);
  return result;
}

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

Row rowOf(const SkipMeasurement& made) {
  return {made.scene,
          text("%.1f %%", 100 * made.map.share(SkipMap::Window::interpolated)),
          text("%.1f %%", 100 * made.map.work),
          text("%.3f", median(made.secondsOff)),
          text("%.3f", median(made.seconds)),
          text("%.3f", median(ratios(made.secondsOff, made.seconds))),
          text("%.3f", made.psnrOff),
          text("%+.4f", made.psnr - made.psnrOff),
          text("%.5f", made.change.interpolated),
          text("%.5f", made.change.computed)};
}

// What skipping costs where it does not find a window to skip.
void printCost(const std::vector<double>& slower) {
  if (slower.empty()) return;
  std::printf(
      "Where nothing is skipped: %zu pairs of runs, time with --skip over that without: median %.4f, quartiles %.4f "
      "and %.4f.\n",
      slower.size(), median(slower), quantile(slower, 0.25), quantile(slower, 0.75));
}

void printSummary(const BenchSkipOptions& options, const std::string& name, const Device& device,
                  const std::vector<Row>& rows, double worst, const std::vector<double>& slower) {
  std::printf(
      "%s, --skip %s (bound %g), model %s (%s), %s: median of %d pairs of runs%s\n\n%s\nLargest change of a window "
      "%.5f: the bound %s.\n",
      options.folder.c_str(), options.skip.c_str(), static_cast<double>(parseSkip(options.skip)), name.c_str(),
      options.precision.c_str(), device.description().name.c_str(), options.runs, options.cpuTime ? ", CPU time" : "",
      aligned(rows).c_str(), worst, worst <= static_cast<double>(parseSkip(options.skip)) ? "holds" : "does not hold");
  printCost(slower);
}

void run(const BenchSkipOptions& options) {
  if (!options.markdown.empty()) requireWritable(options.markdown);
  QualitySetting setting{options.scale, options.colour, options.aux};
  const std::string name = options.model.empty() ? defaultModelName(options.scale) : options.model;
  const Model model = failingWith(ExitCode::model, [&] { return Model(resolveModel(name)); });
  setting.read(model);
  const SceneList list = failingWith(ExitCode::input, [&] { return findScenes(options.folder, setting, {}); });
  Device device = failingWith(ExitCode::device, [&] { return Device({.select = options.device}); });
  std::vector<Row> rows{
      {"scene", "skipped", "work", "s off", "s skip", "faster", "PSNR off", "change dB", "skipped windows", "others"}};
  double worst = 0;
  std::vector<double> slower;
  for (const SceneFiles& files : list.scenes) {
    const Scene scene = failingWith(ExitCode::input, [&] { return loadScene(files, setting); });
    const SkipMeasurement made =
        failingWith(ExitCode::device, [&] { return measureScene(device, model, files, scene, options); });
    if (made.map.work == 1) {
      const std::vector<double> pairs = ratios(made.seconds, made.secondsOff);
      slower.insert(slower.end(), pairs.begin(), pairs.end());
    }
    worst = std::max({worst, made.change.interpolated, made.change.computed});
    rows.push_back(rowOf(made));
  }
  if (!options.quiet) printSummary(options, name, device, rows, worst, slower);
  if (!options.markdown.empty()) failingWith(ExitCode::output, [&] { writeText(options.markdown, markdown(rows)); });
}

}  // namespace

void addBenchSkip(CLI::App& group) {
  const auto options = std::make_shared<BenchSkipOptions>();
  CLI::App* verb = group.add_subcommand("skip", "Compare runs that skip windows with full ones on a folder of scenes");
  verb->add_option("FOLDER", options->folder, "Folder of scenes, as xrds bench quality reads it")->required();
  verb->add_option("--model", options->model, "A shipped model's name or a .safetensors file")->type_name("MODEL");
  verb->add_option("--skip", options->skip, "As in xrds upscale")
      ->check(CLI::Validator(validSkip, "safe|N"))
      ->capture_default_str();
  verb->add_option("--scale", options->scale, "Of the colour's render")->capture_default_str();
  verb->add_option("--samples", options->colour, "Samples a pixel of the colour")->capture_default_str();
  verb->add_option("--aux", options->aux, "Samples a pixel of albedo and normal")->capture_default_str();
  verb->add_option("--runs", options->runs, "Pairs of runs, of which the median is taken")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_flag("--cpu-time", options->cpuTime,
                 "Time what the process takes of the cores: for CPU devices, busy machines");
  verb->add_option("--precision", options->precision, "Storage of activations and weights")
      ->check(CLI::IsMember({kFp32, kFp16}))
      ->capture_default_str();
  verb->add_option("--device", options->device, "Number, part of the name, or UUID (see xrds devices)")
      ->type_name("DEVICE");
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
