#include <cstdio>
#include <memory>

#include "app/stage.h"
#include "cli/commands.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "image/aov.h"
#include "image/compose.h"
#include "image/flip.h"
#include "image/metrics.h"
#include "image/png_write.h"

namespace xrds {
namespace {

struct CompareOptions {
  std::string image, reference, layer, referenceLayer, heatMap;
  float heatMaximum = 0.1F;
  double minimumPsnr = 0;
};

Image readColour(const std::string& path, const std::string& layer) {
  const ExrFile file = readExrHeader(path);
  return readLayer(file, findAov(file, AovRole::kColor, layer));
}

void run(const CompareOptions& options) {
  if (!options.heatMap.empty()) {
    requireExtension(options.heatMap, ".png", "--heat-map");
    requireWritable(options.heatMap);
  }
  const std::string& referenceLayer = options.referenceLayer.empty() ? options.layer : options.referenceLayer;
  const auto [image, reference] = stage(ExitCode::input, [&] {
    std::pair images{readColour(options.image, options.layer), readColour(options.reference, referenceLayer)};
    if (images.first.width != images.second.width || images.first.height != images.second.height)
      throw Error("The images have different sizes: " + std::to_string(images.first.width) + " x " +
                  std::to_string(images.first.height) + " and " + std::to_string(images.second.width) + " x " +
                  std::to_string(images.second.height) + ".");
    return images;
  });
  stopIfInterrupted();
  const Metrics metrics = stage(ExitCode::input, [&] { return measure(image, reference); });
  const double values[] = {
      metrics.psnr, metrics.relMse, metrics.relMseTrimmed, metrics.relMseMedian, metrics.relMsePercentile999,
      metrics.flip};
  const auto definitions = metricDefinitions();
  for (size_t i = 0; i < definitions.size(); ++i) {
    const size_t colon = definitions[i].find(": ");
    std::printf("%-24s %12.6g   %s\n", definitions[i].substr(0, colon).c_str(), values[i],
                definitions[i].substr(colon + 2).c_str());
  }
  stopIfInterrupted();
  if (!options.heatMap.empty())
    stage(ExitCode::output,
          [&] { writePng(options.heatMap, heatMap(flipMap(image, reference), options.heatMaximum)); });
  if (options.minimumPsnr > 0 && metrics.psnr < options.minimumPsnr)
    throw Failure{ExitCode::differs, "PSNR is " + std::to_string(metrics.psnr) + " dB, below " +
                                         std::to_string(options.minimumPsnr) + " dB."};
}

}  // namespace

void addCompare(CLI::App& app) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App* verb = app.add_subcommand("compare", "Compare two images with every metric of the project");
  verb->add_option("IMAGE", options->image, "EXR file to judge")->required();
  verb->add_option("REFERENCE", options->reference, "EXR file that is right")->required();
  verb->add_option("--layer", options->layer, "Layer to compare (default: the colour)")->type_name("LAYER");
  verb->add_option("--reference-layer", options->referenceLayer, "Layer of REFERENCE (default: that of --layer)")
      ->type_name("LAYER");
  verb->add_option("--heat-map", options->heatMap, "PNG file to write with the perceptual error of each pixel")
      ->type_name("PNG");
  verb->add_option("--heat-max", options->heatMaximum, "Error that is shown brightest")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_option("--min-psnr", options->minimumPsnr, "Exit with code 7 if the PSNR is lower")->type_name("DB");
  verb->footer(
      "Examples:\n  xrds compare out.exr reference.exr\n  xrds compare out.exr reference.exr --heat-map error.png");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
