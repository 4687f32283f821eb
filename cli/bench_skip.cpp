#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include "app/models.h"
#include "app/skip_bound.h"
#include "app/stage.h"
#include "cli/commands.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/quality_scenes.h"
#include "cli/table.h"
#include "image/metrics.h"

namespace xrds {
namespace {

struct BenchSkipOptions {
  std::string folder, model, device, markdown, skip = "safe", precision = "fp32";
  int scale = 4, runs = 5, colour = 64, aux = 16;

  Upscaler::Options upscaler(float bound) const { return {.fp16 = precision == "fp16", .skip = {.bound = bound}}; }
};

/// The largest change of a window, root mean square of log(1 + exposure radiance).
struct LargestChange {
  double interpolated = 0, computed = 0;
};

/// One scene without and with skipping.
struct SkipMeasurement {
  std::string scene;
  SkipMap map;
  double secondsOff = 0, seconds = 0, psnrOff = 0, psnr = 0;
  LargestChange change;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
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

// Both are run once before, so that everything is compiled and planned, then in turn.
SkipMeasurement measureScene(Device& device, const Model& model, const SceneFiles& files, const Scene& scene,
                             const BenchSkipOptions& options) {
  const Frame& frame = scene.frame;
  Upscaler full(device, model, frame.width(), frame.height(), options.upscaler(0));
  Upscaler skipping(device, model, frame.width(), frame.height(), options.upscaler(parseSkip(options.skip)));
  const auto auxiliary = viewsOf(frame.auxiliary());
  const auto seconds = [&](Upscaler& upscaler, Image& result) {
    const auto start = std::chrono::steady_clock::now();
    upscaler.run(viewOf(frame.colour()), auxiliary, result.pixels, [](double) { return !interrupted(); });
    stopIfInterrupted();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  Image off(scene.reference.width, scene.reference.height, 3), on = off;
  std::vector<double> secondsOff, secondsOn;
  for (int run = -1; run < options.runs; ++run) {
    const double first = seconds(full, off), second = seconds(skipping, on);
    if (run < 0) continue;
    secondsOff.push_back(first);
    secondsOn.push_back(second);
  }
  SkipMeasurement made{files.name, skipping.skipMap(), median(secondsOff), median(secondsOn)};
  made.psnrOff = psnr(off, scene.reference);
  made.psnr = psnr(on, scene.reference);
  made.change = largestChange(off, on, made.map, full.exposure());
  return made;
}

Row rowOf(const SkipMeasurement& made) {
  return {made.scene,
          text("%.1f %%", 100 * made.map.share(SkipMap::Window::interpolated)),
          text("%.1f %%", 100 * made.map.work),
          text("%.3f", made.secondsOff),
          text("%.3f", made.seconds),
          text("%.3f", made.secondsOff / made.seconds),
          text("%.3f", made.psnrOff),
          text("%+.4f", made.psnr - made.psnrOff),
          text("%.5f", made.change.interpolated),
          text("%.5f", made.change.computed)};
}

void run(const BenchSkipOptions& options) {
  if (!options.markdown.empty()) requireWritable(options.markdown);
  const QualitySetting setting{options.scale, options.colour, options.aux};
  const std::string name = options.model.empty() ? defaultModelName(options.scale) : options.model;
  const Model model = stage(ExitCode::model, [&] { return Model(resolveModel(name)); });
  const SceneList list = stage(ExitCode::input, [&] { return findScenes(options.folder, setting, {}); });
  Device device = stage(ExitCode::device, [&] { return Device({.select = options.device}); });
  std::vector<Row> rows{
      {"scene", "skipped", "work", "s off", "s skip", "faster", "PSNR off", "change dB", "skipped windows", "others"}};
  double worst = 0;
  for (const SceneFiles& files : list.scenes) {
    const Scene scene = stage(ExitCode::input, [&] { return loadScene(files, setting); });
    const SkipMeasurement made =
        stage(ExitCode::device, [&] { return measureScene(device, model, files, scene, options); });
    worst = std::max({worst, made.change.interpolated, made.change.computed});
    rows.push_back(rowOf(made));
  }
  std::printf(
      "%s, --skip %s (bound %g), model %s (%s), %s: median of %d runs in turn\n\n%s\nLargest change of a window "
      "%.5f: the bound %s.\n",
      options.folder.c_str(), options.skip.c_str(), static_cast<double>(parseSkip(options.skip)), name.c_str(),
      options.precision.c_str(), device.description().name.c_str(), options.runs, aligned(rows).c_str(), worst,
      worst <= static_cast<double>(parseSkip(options.skip)) ? "holds" : "does not hold");
  if (!options.markdown.empty()) stage(ExitCode::output, [&] { writeText(options.markdown, markdown(rows)); });
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
  verb->add_option("--colour", options->colour, "Samples a pixel of the colour")->capture_default_str();
  verb->add_option("--aux", options->aux, "Samples a pixel of albedo and normal")->capture_default_str();
  verb->add_option("--runs", options->runs, "Of which the median is taken")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_option("--precision", options->precision, "Storage of activations and weights")
      ->check(CLI::IsMember({"fp32", "fp16"}))
      ->capture_default_str();
  verb->add_option("--device", options->device, "Number, part of the name, or UUID (see xrds devices)")
      ->type_name("DEVICE");
  verb->add_option("--markdown", options->markdown, "File to write with the table")->type_name("MD");
  verb->footer(
      "Each scene is upscaled in full and with --skip, in turn, after one run of each. skipped: share of the windows\n"
      "that were interpolated; work: pixels computed, surroundings included, over all; the last two columns: the\n"
      "largest change of a window, root mean square of log(1 + exposure radiance), among those skipped and the "
      "others.");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
