#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include "app/failing_with.h"
#include "app/models.h"
#include "cli/bench/tiles_report.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "image/compose.h"
#include "image/metrics/metrics.h"
#include "image/png_write.h"
#include "image/srgb.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

struct BenchTilesOptions {
  std::string folder, model, device, heatMap, json, precision = kFp32;
  std::vector<uint32_t> halos{0, 8, 16, 24, 32, 48};
  bool halosAsked = false;  // else those that fit every scene
  uint32_t columns = 2, rows = 1;
  int colour = 64, aux = 16;
  bool quiet = false;
};

double level(float radiance) { return 255 * displayValue(radiance); }

// The largest change of the difference from one pixel to the next: a seam is such a change.
double largestStep(const Image& tiled, const Image& whole) {
  double largest = 0;
  const auto difference = [&](int x, int y, int c) { return level(tiled.at(x, y, c)) - level(whole.at(x, y, c)); };
  for (int y = 0; y < whole.height; ++y)
    for (int x = 0; x < whole.width; ++x)
      for (int c = 0; c < 3; ++c) {
        if (tiled.at(x, y, c) == whole.at(x, y, c)) continue;
        for (const auto& [i, j] : {std::pair{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}})
          if (i >= 0 && j >= 0 && i < whole.width && j < whole.height)
            largest = std::max(largest, std::abs(difference(x, y, c) - difference(i, j, c)));
      }
  return largest;
}

TileError errorOf(const Image& tiled, const Image& whole, const Image& reference, float exposure) {
  TileError error{.step = largestStep(tiled, whole), .psnr = psnr(tiled, reference) - psnr(whole, reference)};
  double difference = 0, power = 0;
  for (size_t i = 0; i < whole.pixels.size(); ++i) {
    const double a = std::log1p(exposure * tiled.pixels[i]), b = std::log1p(exposure * whole.pixels[i]);
    difference += (a - b) * (a - b);
    power += b * b;
  }
  error.relativeRms = power > 0 ? std::sqrt(difference / power) : 0;
  return error;
}

// The largest channel's difference of the sRGB pictures, in 255ths.
Image differenceMap(const Image& tiled, const Image& whole) {
  Image map(whole.width, whole.height, 1);
  for (size_t p = 0; p < whole.pixelCount(); ++p)
    for (size_t c = 0; c < 3; ++c)
      map.pixels[p] = std::max(
          map.pixels[p], static_cast<float>(std::abs(level(tiled.pixels[3 * p + c]) - level(whole.pixels[3 * p + c]))));
  return map;
}

/// Upscales the frame, whole or in tiles.
class Runner {
 public:
  Runner(const BenchTilesOptions& options, Device& device, const Model& model, const Frame& frame)
      : options_(options), device_(device), model_(model), frame_(frame) {}

  Image run(const TileOptions& tiles) {
    const int scale = static_cast<int>(model_.scale());
    Image result(frame_.colour().width * scale, frame_.colour().height * scale, 3);
    Upscaler upscaler(device_, model_, frame_.width(), frame_.height(),
                      {.fp16 = options_.precision == kFp16, .tiles = tiles});
    const auto auxiliary = inputsOf(model_, frame_);
    upscaler.run(viewOf(frame_.colour()), auxiliary, result.pixels, [](double) { return !interrupted(); });
    stopIfInterrupted();
    exposure = upscaler.exposure();
    return result;
  }

  float exposure = 1;  // of the last run

 private:
  const BenchTilesOptions& options_;
  Device& device_;
  const Model& model_;
  const Frame& frame_;
};

// Throws Error for a halo that no frame can have.
void requireHalos(const std::vector<uint32_t>& halos, const Model& model) {
  constexpr uint32_t kAnySide = 64;
  const uint32_t side = kAnySide * model.scale();
  for (const uint32_t halo : halos) model.tiling(side, side, false, {.halo = halo});
}

// A pure question, which needs no device.
bool fits(const TileOptions& tiles, const Model& model, const Frame& frame) {
  try {
    model.tiling(model.scale() * frame.width(), model.scale() * frame.height(), false, tiles);
    return true;
  } catch (const Error&) {
    return false;
  }
}

void measureScene(const BenchTilesOptions& options, Device& device, const Model& model, const SceneFiles& files,
                  const QualitySetting& setting, std::vector<HaloErrors>& errors) {
  const Scene scene = failingWith(ExitCode::input, [&] { return loadScene(files, setting); });
  Runner runner(options, device, model, scene.frame);
  const Image whole = runner.run({});
  std::vector<Image> maps;
  for (size_t i = 0; i < options.halos.size(); ++i) {
    const TileOptions tiles{.halo = options.halos[i], .columns = options.columns, .rows = options.rows};
    if (!fits(tiles, model, scene.frame)) {
      if (options.halosAsked || i == 0)
        throw Failure{ExitCode::usage, "Scene '" + files.name + "' is too small for " +
                                           std::to_string(options.columns) + " x " + std::to_string(options.rows) +
                                           " tiles with a halo of " + std::to_string(options.halos[i]) + "."};
      continue;
    }
    const Image tiled = runner.run(tiles);
    errors[i].scenes.push_back(errorOf(tiled, whole, scene.reference, runner.exposure));
    if (!options.heatMap.empty()) maps.push_back(heatMap(differenceMap(tiled, whole), 8));
  }
  if (!options.heatMap.empty())
    failingWith(ExitCode::output,
                [&] { writePng(pathOf(options.heatMap) / pathOf(files.name + ".png"), sideBySide(maps, 4)); });
}

void run(const BenchTilesOptions& options) {
  requireOutput(options.json, ".json", "--json");
  const Model model = failingWith(ExitCode::model, [&] { return Model(resolveModel(options.model)); });
  if (options.halosAsked) failingWith(ExitCode::usage, [&] { requireHalos(options.halos, model); });
  const QualitySetting setting = settingFor(model, options.colour, options.aux);
  const SceneList list = failingWith(ExitCode::input, [&] { return findScenes(pathOf(options.folder), setting, {}); });
  Device device = failingWith(ExitCode::device, [&] { return Device({.select = options.device}); });
  TilesReport report{{options.folder, options.model, model.hash(), options.precision, setting, device.description()},
                     options.columns,
                     options.rows};
  for (const SceneFiles& files : list.scenes) report.sceneNames.push_back(files.name);
  std::vector<HaloErrors> errors;
  for (const uint32_t halo : options.halos) errors.push_back({halo});
  {
    ProgressBar bar(options.quiet);
    for (size_t i = 0; i < list.scenes.size(); ++i) {
      failingWith(ExitCode::device, [&] { measureScene(options, device, model, list.scenes[i], setting, errors); });
      bar.update(static_cast<double>(i + 1) / static_cast<double>(list.scenes.size()));
      stopIfInterrupted();
    }
  }
  for (const HaloErrors& found : errors)
    if (found.scenes.size() == list.scenes.size()) report.halos.push_back(found);
  if (!options.quiet) std::fputs(plainText(report).c_str(), stdout);
  if (!options.json.empty()) failingWith(ExitCode::output, [&] { writeText(options.json, jsonText(report)); });
}

}  // namespace

void addBenchTiles(CLI::App& group) {
  const auto options = std::make_shared<BenchTilesOptions>();
  CLI::App* verb = group.add_subcommand("tiles", "Measure what tiles with smaller halos lose");
  verb->add_option("FOLDER", options->folder, "Folder of scenes, as bench quality takes it")->required();
  verb->add_option("--model", options->model, "A shipped model's name or a .safetensors file")
      ->required()
      ->type_name("MODEL");
  verb->add_option(
          "--halo", options->halos,
          "Low-resolution pixels around the tiles, with commas: whole windows; by default those that fit all scenes")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str()
      ->type_name("N");
  verb->add_option("--columns", options->columns, "Tiles in a row")->check(CLI::Range(1, 64))->capture_default_str();
  verb->add_option("--rows", options->rows, "Rows of tiles")->check(CLI::Range(1, 64))->capture_default_str();
  addSceneSamples(*verb, options->colour, options->aux);
  addPrecision(*verb, options->precision);
  addDevice(*verb, options->device);
  verb->add_option(
          "--heat-map", options->heatMap,
          "Folder for one PNG a scene: the difference to the whole frame, a panel for each halo, 8 levels of 255 "
          "and more brightest")
      ->check(CLI::ExistingDirectory)
      ->type_name("FOLDER");
  addReportFile(*verb, options->json);
  addQuiet(*verb, options->quiet);
  verb->footer(
      "Each scene is upscaled as a whole and in tiles. RMS: of the difference over that of the whole frame, both as\n"
      "log(1 + e x). PSNR: against the reference, less that of the whole frame, in dB. Largest step: by how much the\n"
      "difference of the sRGB pictures changes between two neighbouring pixels, in 255ths: a seam at its worst.\n\n"
      "Example:\n  xrds bench tiles val --model xrds-x4-nano --halo 0,8,16,24");
  verb->callback([options, verb] {
    options->halosAsked = verb->count("--halo") > 0;
    run(*options);
  });
}

}  // namespace xrds
