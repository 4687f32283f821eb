#include <cstdio>
#include <cstdlib>
#include <memory>

#include "app/byte_count.h"
#include "app/failing_with.h"
#include "app/frame.h"
#include "app/network_denoiser.h"
#include "cli/alpha.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/device_choice.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/timer.h"
#include "cli/warnings.h"
#include "image/aov.h"
#include "image/png_write.h"

namespace xrds {
namespace {

struct DenoiseOptions {
  std::string color, aux, output, preview, guides = "prefilter", quality = "high", folder, precision = "fp32",
                                           exposure = "auto", memory, device;
  AovRequest layers;
  bool ldr = false, half = false, quiet = false;
};

std::vector<std::string> inputsOf(const DenoiseOptions& options) {
  if (options.guides == "none") return {};
  const ExrFile file = readExrHeader(options.aux.empty() ? options.color : options.aux);
  const auto isThere = [&](AovRole role) { return !options.layers.nameOf(role).empty() || hasAov(file, role); };
  std::vector<std::string> inputs;
  if (isThere(AovRole::kAlbedo)) inputs.emplace_back(kAlbedo.name);
  if (!inputs.empty() && isThere(AovRole::kNormal)) inputs.emplace_back(kNormal.name);
  if (inputs.empty() && !options.aux.empty())
    throw Error("'" + options.aux + "' holds no albedo: name its layer with --albedo, or denoise the colour alone.");
  return inputs;
}

Frame openFrame(const DenoiseOptions& options) {
  Frame frame(options.color, options.aux, options.layers, inputsOf(options), {.never = true});
  if (frame.scale() > 1)
    throw Error("Albedo and normal have " + std::to_string(frame.scale()) +
                " times the colour's size: a denoiser takes images of one size; xrds upscale is for these.");
  frame.load();
  return frame;
}

NetworkDenoiser::Options optionsOf(const DenoiseOptions& options, std::optional<ProgressBar>& bar) {
  using Quality = NetworkDenoiser::Quality;
  NetworkDenoiser::Options result{.folder = options.folder,
                                  .quality = options.quality == "high"   ? Quality::high
                                             : options.quality == "fast" ? Quality::fast
                                                                         : Quality::balanced,
                                  .ldr = options.ldr,
                                  .fp16 = options.precision == "fp16",
                                  .memoryBytes = parseBytes(options.memory),
                                  .progress = [&bar](double share) { return bar->update(share); }};
  if (options.exposure != "auto") result.exposure = std::strtof(options.exposure.c_str(), nullptr);
  return result;
}

Image denoise(NetworkDenoiser& denoiser, Device& device, const Frame& frame, const std::string& guides) {
  const auto& images = frame.auxiliary();
  const Image *albedo = images.empty() ? nullptr : &images[0], *normal = images.size() < 2 ? nullptr : &images[1];
  if (guides == "prefilter") return denoiser.prefiltered(device, frame.colour(), albedo, normal);
  return denoiser.denoised(device, frame.colour(), albedo, normal, guides == "clean");
}

void write(const DenoiseOptions& options, const Frame& frame, const Image& picture, const std::string& denoiser) {
  ExrOutput output = frame.output(1);
  output.texts["xrds:version"] = XRDS_VERSION;
  output.texts["xrds:denoiser"] = denoiser;
  output.texts["xrds:options"] = "guides=" + options.guides + " precision=" + options.precision;
  output.pixelType = options.half ? ExrPixelType::kHalf : ExrPixelType::kFloat;
  failingWith(ExitCode::output, [&] {
    writeExr(options.output, frame.alpha() ? withAlpha(picture, *frame.alpha()) : picture, output);
    if (!options.preview.empty()) writePng(options.preview, picture);
  });
}

void run(const DenoiseOptions& options) {
  const Timer whole;
  requireExtension(options.output, ".exr", "--output");
  if (!options.preview.empty()) requireExtension(options.preview, ".png", "--preview");
  for (const std::string& path : {options.output, options.preview})
    if (!path.empty()) requireWritable(path);
  const Frame frame = failingWith(ExitCode::input, [&] { return openFrame(options); });
  printWarnings(frame.warnings());
  stopIfInterrupted();
  std::optional<ProgressBar> bar;
  NetworkDenoiser denoiser(optionsOf(options, bar));
  failingWith(ExitCode::model, [&] {
    const size_t guides = frame.auxiliary().size();
    denoiser.load(guides, options.guides == "clean", guides == 2 && options.guides == "prefilter");
  });
  onDevice(options.device, options.quiet, [&](Device& device) {
    Image picture;
    bar.emplace(options.quiet);
    try {
      picture = denoise(denoiser, device, frame, options.guides);
    } catch (const Cancelled&) {
      stopIfInterrupted();
      throw;
    }
    bar.reset();
    write(options, frame, picture, denoiser.name());
    if (options.quiet) return;
    const Tiling& tiling = denoiser.tiling();
    std::printf("%s: %d x %d pixels by %s on %s\n", options.output.c_str(), picture.width, picture.height,
                denoiser.name().c_str(), device.description().name.c_str());
    std::printf("%.2f s of the device, %.2f s in all; %.0f MB of device memory, %u x %u tiles\n", denoiser.runSeconds(),
                whole.seconds(), static_cast<double>(denoiser.deviceBytes()) / 1e6, tiling.columns, tiling.rows);
  });
}

std::string validExposure(const std::string& text) {
  char* end = nullptr;
  const float value = std::strtof(text.c_str(), &end);
  return text == "auto" || (*end == '\0' && Upscaler::isExposure(value)) ? "" : "expected auto or a number above 0";
}

void addOptions(CLI::App& verb, DenoiseOptions& options) {
  verb.add_option("COLOR", options.color, "EXR file with the noisy colour")->required();
  verb.add_option("AUX", options.aux, "EXR file with albedo and normal of its size (default: those in COLOR, if any)");
  verb.add_option("-o,--output", options.output, "EXR file to write: R, G, B (and A), 32-bit float, ZIP")
      ->required()
      ->type_name("EXR");
  verb.add_option("--preview", options.preview, "PNG file to write as well, with the sRGB curve")->type_name("PNG");
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
  verb.add_option("--exposure", options.exposure, "Factor that brings radiance to a mean log luminance of 0.18")
      ->check(CLI::Validator(validExposure, "auto|E"))
      ->capture_default_str();
  verb.add_option("--denoisers", options.folder, "Folder with the networks (default: where xrds import oidn puts them)")
      ->type_name("FOLDER");
  verb.add_option("--precision", options.precision, "Storage of activations and weights")
      ->check(CLI::IsMember({"fp32", "fp16"}))
      ->capture_default_str();
  addDevice(verb, options.device);
  verb.add_option(
          "--memory", options.memory,
          "Device memory to use at most, such as 256M or 2G (default: three quarters of what the device has); a "
          "frame that\nneeds more is cut into tiles, with the same picture")
      ->check(CLI::Validator(validBytes, "BYTES"));
  verb.add_option("--color,--colour", options.layers.names[AovRole::kColor], "Layer to take as colour")
      ->type_name("LAYER");
  verb.add_option("--albedo", options.layers.names[AovRole::kAlbedo], "Layer to take as albedo")->type_name("LAYER");
  verb.add_option("--normal", options.layers.names[AovRole::kNormal], "Layer to take as normal")->type_name("LAYER");
  addQuiet(verb, options.quiet);
  verb.add_flag("--half", options.half, "Write 16-bit half floats");
  verb.footer(
      "Runs the networks of your own copy of Open Image Denoise on any Vulkan device: import them once with xrds "
      "import "
      "oidn.\n\nExamples:\n"
      "  xrds denoise render.exr -o out.exr\n"
      "  xrds denoise color.exr guides.exr -o out.exr --guides noisy --precision fp16");
}

}  // namespace

void addDenoise(CLI::App& app) {
  const auto options = std::make_shared<DenoiseOptions>();
  CLI::App* verb = app.add_subcommand("denoise", "Take the noise out of a frame with Open Image Denoise's networks");
  addOptions(*verb, *options);
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
