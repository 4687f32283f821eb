#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "app/byte_count.h"
#include "app/failing_with.h"
#include "app/frame.h"
#include "app/layer_options.h"
#include "app/network_denoiser.h"
#include "app/timer.h"
#include "cli/alpha.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/denoise_sequence.h"
#include "cli/device_choice.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/sequence_run.h"
#include "cli/upscale_frame.h"
#include "cli/warnings.h"
#include "image/png_write.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

void write(const DenoiseOptions& options, const Frame& frame, const Denoised& found, const std::string& denoiser) {
  failingWith(ExitCode::output, [&] {
    const UpscaleOptions& common = options.common;
    const Image whole = frame.alpha() ? withAlpha(found.picture, *frame.alpha()) : found.picture;
    writePicture(pathOf(common.output), frame, whole, found.layers, outputOf(options, frame, denoiser));
    if (!common.preview.empty()) writePng(pathOf(common.preview), found.picture);
  });
}

/// The progress of several runs, one after the other, each of which tells growing shares up to 1.
class RunsBar {
 public:
  RunsBar(bool quiet, size_t runs) : bar_(quiet), runs_(static_cast<double>(runs)) {}
  bool update(double share) {
    if (share <= last_) ++done_;
    last_ = share;
    return bar_.update(std::min(1.0, (done_ + share) / runs_));
  }

 private:
  ProgressBar bar_;
  const double runs_;
  double done_ = 0, last_ = 0;
};

/// Gives back what stayed prepared for one light after the other, before the device goes.
struct Released {
  NetworkDenoiser& networks;
  ~Released() { networks.release(); }
};

void denoiseOne(const DenoiseOptions& options) {
  const Timer whole;
  const UpscaleOptions& common = options.common;
  requireOutput(common.output, ".exr", "--output");
  requireOutput(common.preview, ".png", "--preview");
  const Frame frame = failingWith(ExitCode::input, [&] {
    Frame opened = openFrame(options, common.color, common.aux);
    opened.load();
    if (const LayerRequest request = layerRequest(common.lights); request.any()) opened.loadLayers(request, 1);
    return opened;
  });
  printWarnings(frame.warnings());
  stopIfInterrupted();
  std::optional<RunsBar> bar;
  NetworkDenoiser denoiser(networksOf(options, [&bar](double share) { return bar->update(share); }));
  failingWith(ExitCode::model, [&] {
    const size_t guides = frame.auxiliary().size();
    denoiser.load(guides, areClean(options), arePrefiltered(options, guides));
  });
  onDevice(common.device, common.quiet, [&](Device& device) {
    const Released released{denoiser};
    bar.emplace(common.quiet, runsFor(frame, options));
    const Denoised found = denoised(denoiser, device, frame, options);
    bar.reset();
    write(options, frame, found, denoiser.name());
    if (frame.layers()) printWarnings(frame.layers()->warnings(found.layers));
    if (common.quiet) return;
    const Tiling& tiling = denoiser.tiling();
    std::printf("%s: %d x %d pixels by %s on %s\n", common.output.c_str(), found.picture.width, found.picture.height,
                denoiser.name().c_str(), device.description().name.c_str());
    std::printf("%.2f s of the device, %.2f s in all; %.0f MB of device memory, %u x %u tiles\n", denoiser.runSeconds(),
                whole.seconds(), static_cast<double>(denoiser.deviceBytes()) / 1e6, tiling.columns, tiling.rows);
    if (frame.layers()) std::fputs(layersText(frame.layers()->list()).c_str(), stdout);
  });
}

void addOptions(CLI::App& verb, DenoiseOptions& options) {
  UpscaleOptions& common = options.common;
  verb.add_option("COLOR", common.color, "EXR file with the noisy colour")->required();
  verb.add_option("AUX", common.aux, "EXR file with albedo and normal of its size (default: those in COLOR, if any)");
  verb.add_option("-o,--output", common.output, "EXR file to write: R, G, B (and A), 32-bit float, ZIP")
      ->required()
      ->type_name("EXR");
  verb.add_option("--preview", common.preview, "PNG file to write as well, with the sRGB curve")->type_name("PNG");
  verb.add_option("--guides", options.guides,
                  "Albedo and normal: prefilter (each is denoised first, the best picture), noisy (as they are), clean "
                  "(they have\nno noise), none (the colour alone)")
      ->check(CLI::IsMember({"prefilter", "noisy", "clean", "none"}))
      ->capture_default_str();
  verb.add_option("--quality", options.quality, "Size of the networks: high takes the large ones where there are any")
      ->check(CLI::IsMember({"high", "balanced", "fast"}))
      ->capture_default_str();
  verb.add_flag("--ldr", options.ldr,
                "The colour is linear from 0 to 1 and stays so (default: radiance without bound)");
  addExposure(verb, common.exposure, "Factor that brings radiance to a mean log luminance of 0.18");
  verb.add_option("--denoisers", common.denoisers,
                  "Folder with the networks (default: where xrds import oidn puts them)")
      ->type_name("FOLDER");
  addPrecision(verb, common.precision);
  addDevice(verb, common.device);
  verb.add_option(
          "--memory", common.memory,
          "Device memory to use at most, such as 256M or 2G (default: three quarters of what the device has); a "
          "frame that\nneeds more is cut into tiles, with the same picture")
      ->check(CLI::Validator(validBytes, "BYTES"));
  verb.add_option("--color,--colour", common.layers.names[AovRole::kColor], "Layer to take as colour")
      ->type_name("LAYER");
  verb.add_option("--albedo", common.layers.names[AovRole::kAlbedo], "Layer to take as albedo")->type_name("LAYER");
  verb.add_option("--normal", common.layers.names[AovRole::kNormal], "Layer to take as normal")->type_name("LAYER");
  addLights(
      verb, common.lights,
      "Layers of light to denoise as well, so that they still add up to the result: all (those that Cycles names,\n"
      "light groups too), or names with commas. Every other layer that is no light, such\n"
      "as depth, ids and Cryptomatte, is copied bit for bit");
  addSequenceOptions(verb, common);
  addQuiet(verb, common.quiet);
  verb.add_flag("--half", common.half, "Write 16-bit half floats");
  verb.footer(
      "Runs the networks of your own copy of Open Image Denoise on any Vulkan device: import them once with xrds "
      "import "
      "oidn.\n\nSequences: as of xrds upscale, with #### or %04d in the names of the files.\n\nExamples:\n"
      "  xrds denoise render.exr -o out.exr\n"
      "  xrds denoise color.exr guides.exr -o out.exr --guides noisy --precision fp16\n"
      "  xrds denoise render.####.exr -o out/frame.####.exr --temporal --skip-existing");
}

}  // namespace

void addDenoise(CLI::App& app) {
  const auto options = std::make_shared<DenoiseOptions>();
  CLI::App* verb =
      app.add_subcommand("denoise", "Take the noise out of a frame, or a sequence, with Open Image Denoise's networks");
  addOptions(*verb, *options);
  verb->callback([options] {
    if (options->ldr && options->common.exposure != "auto")
      throw Failure{ExitCode::usage, "--exposure is of radiance without bound: it cannot go with --ldr."};
    isSequence(options->common) ? denoiseSequence(*options) : denoiseOne(*options);
  });
}

}  // namespace xrds
