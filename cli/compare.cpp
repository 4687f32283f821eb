#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/failing_with.h"
#include "app/number_range.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/json_text.h"
#include "cli/metric_columns.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/warnings.h"
#include "image/compose.h"
#include "image/layers/aov.h"
#include "image/metrics/flip.h"
#include "image/metrics/metrics.h"
#include "image/png_write.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

struct CompareOptions {
  std::string image, reference, layer, referenceLayer, heatMap, json;
  float heatMaximum = 0.1F;
  std::optional<double> minimumPsnr;
  bool quiet = false;
};

/// An image and where it lies in its frame.
struct Placed {
  Image image;
  Box window;
};

Placed readPlaced(const std::string& path, const std::string& layer, const std::string& option) {
  const ExrFile file = readExrHeader(pathOf(path));
  const ExrSelection found = findColourOrNormal(file, layer, option);
  return {readLayer(file, found), file.parts[found.part].dataWindow};
}

void requireOutputs(const CompareOptions& options) {
  requireOutput(options.heatMap, ".png", "--heat-map");
  requireOutput(options.json, ".json", "--json");
}

std::pair<Image, Image> readImages(const CompareOptions& options) {
  const std::string& referenceLayer = options.referenceLayer.empty() ? options.layer : options.referenceLayer;
  Placed image = readPlaced(options.image, options.layer, "--layer"),
         reference = readPlaced(options.reference, referenceLayer, "--reference-layer");
  if (image.image.width != reference.image.width || image.image.height != reference.image.height)
    throw Error("The images have different sizes: " + std::to_string(image.image.width) + " x " +
                std::to_string(image.image.height) + " and " + std::to_string(reference.image.width) + " x " +
                std::to_string(reference.image.height) + ".");
  if (image.window != reference.window)
    printWarnings({"the data windows are " + toString(image.window) + " and " + toString(reference.window) +
                   ": pixels are compared from their corners."});
  return {std::move(image.image), std::move(reference.image)};
}

void printMetrics(const Metrics& metrics) {
  const auto definitions = metricDefinitions();
  for (size_t i = 0; i < definitions.size(); ++i) {
    const size_t colon = definitions[i].find(": ");
    std::printf("%-24s %12.6g   %s\n", definitions[i].substr(0, colon).c_str(), metrics.*metricColumns()[i].field,
                definitions[i].substr(colon + 2).c_str());
  }
}

std::string jsonText(const CompareOptions& options, const Image& image, const Metrics& metrics) {
  nlohmann::ordered_json json{{"version", XRDS_VERSION},
                              {"image", options.image},
                              {"reference", options.reference},
                              {"width", image.width},
                              {"height", image.height}};
  json["metrics"] = jsonOf(metrics);
  return textOf(json);
}

void run(const CompareOptions& options) {
  requireOutputs(options);
  const auto [image, reference] = failingWith(ExitCode::input, [&] { return readImages(options); });
  stopIfInterrupted();
  const Metrics metrics = failingWith(ExitCode::input, [&] { return measure(image, reference); });
  if (!options.quiet) printMetrics(metrics);
  stopIfInterrupted();
  failingWith(ExitCode::output, [&] {
    if (!options.json.empty()) writeText(options.json, jsonText(options, image, metrics));
    if (!options.heatMap.empty())
      writePng(pathOf(options.heatMap), heatMap(flipMap(image, reference), options.heatMaximum));
  });
  if (options.minimumPsnr && !(metrics.psnr >= *options.minimumPsnr))
    throw Failure{ExitCode::differs, "PSNR is " + std::to_string(metrics.psnr) + " dB, below " +
                                         std::to_string(*options.minimumPsnr) + " dB."};
}

}  // namespace

void addCompare(CLI::App& app) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App* verb = app.add_subcommand("compare", "Compare two images with every metric of the project");
  verb->add_option("IMAGE", options->image, "EXR file to judge")->required();
  verb->add_option("REFERENCE", options->reference, "EXR file that is right")->required();
  verb->add_option("--layer", options->layer, "Layer to compare, of channels R, G, B or X, Y, Z (default: the colour)")
      ->type_name("LAYER");
  verb->add_option("--reference-layer", options->referenceLayer, "Layer of REFERENCE (default: that of --layer)")
      ->type_name("LAYER");
  verb->add_option("--heat-map", options->heatMap, "PNG file to write with the perceptual error of each pixel")
      ->type_name("PNG");
  verb->add_option("--heat-max", options->heatMaximum, "Error that is shown brightest")
      ->check(numberIn(1e-6, 1))
      ->capture_default_str();
  verb->add_option("--min-psnr", options->minimumPsnr, "Exit with code 7 if the PSNR is lower")
      ->type_name("DB")
      ->check(numberIn(0, 1000));
  verb->add_option("--json", options->json, "File to write with every metric")->type_name("JSON");
  addQuiet(*verb, options->quiet);
  verb->footer(
      "Examples:\n  xrds compare out.exr reference.exr\n  xrds compare out.exr reference.exr --heat-map error.png");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
