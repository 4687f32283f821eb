#include <chrono>
#include <cstdio>
#include <memory>

#include "cli/commands.h"
#include "cli/frame.h"
#include "cli/models.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/stage.h"
#include "image/png_write.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

struct UpscaleOptions {
  std::string color, aux, output, model, device, reference, preview, sideBySide, precision = "fp32", exposure = "auto";
  AovRequest layers;
  bool half = false, profile = false, check = false, quiet = false;

  Upscaler::Options upscaler() const {
    Upscaler::Options options{.fp16 = precision == "fp16", .profile = profile};
    if (exposure != "auto") options.exposure = std::stof(exposure);
    return options;
  }
};

struct Timer {
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); }
};

std::string validExposure(const std::string& text) {
  if (text == "auto") return {};
  char* end = nullptr;
  const float value = std::strtof(text.c_str(), &end);
  return *end == 0 && value > 0 && value < 1e30f ? "" : "expected auto or a positive number, found '" + text + "'";
}

std::string modelName(const UpscaleOptions& options) {
  if (!options.model.empty()) return options.model;
  const int scale = stage(ExitCode::input, [&] { return findScale(options.color, options.aux, options.layers); });
  return defaultModel(scale);
}

// Alpha has no model of its own: bicubic, on the same device.
Image upscaleAlpha(Device& device, const Image& alpha, int scale) {
  Image spread(alpha.width, alpha.height, 3);
  for (size_t p = 0; p < alpha.pixelCount(); ++p)
    for (size_t c = 0; c < 3; ++c) spread.pixels[3 * p + c] = alpha.pixels[p * alpha.channels];
  const Image upscaled = runBaseline(device, "bicubic", "none", spread, {}, scale);
  Image result(upscaled.width, upscaled.height, 1);
  for (size_t p = 0; p < result.pixelCount(); ++p) result.pixels[p] = std::min(1.f, upscaled.pixels[3 * p]);
  return result;
}

Image withAlpha(const Image& colour, const Image& alpha) {
  Image joined(colour.width, colour.height, 4);
  for (size_t p = 0; p < joined.pixelCount(); ++p) {
    std::copy_n(&colour.pixels[3 * p], 3, &joined.pixels[4 * p]);
    joined.pixels[4 * p + 3] = alpha.pixels[p];
  }
  return joined;
}

void writeResult(const UpscaleOptions& options, const Frame& frame, const Model& model, const Image& result,
                 const Image& preview) {
  stage(ExitCode::output, [&] {
    ExrOutput output = scaledOutput(frame.colorPart(), static_cast<int>(model.scale()));
    output.texts["xrds:version"] = XRDS_VERSION;
    output.texts["xrds:model"] = fs::path(resolveModel(options.model)).stem().string() + " " + model.hash();
    output.texts["xrds:options"] = "precision=" + options.precision + " exposure=" + options.exposure;
    output.pixelType = options.half ? ExrPixelType::kHalf : ExrPixelType::kFloat;
    writeExr(options.output, result, output);
    if (!options.preview.empty()) writePng(options.preview, preview);
  });
}

void runCheck(Device& device, const Model& model, const Frame& frame, const UpscaleOptions& options) {
  const auto rows = stage(ExitCode::device, [&] { return checkOnCrop(device, model, frame, options.upscaler()); });
  const int divergent = printCheck(rows);
  if (divergent >= 0)
    throw Failure{ExitCode::differs, "The device diverges from the reference, first at operator '" + rows[divergent].label + "'."};
}

void run(UpscaleOptions options) {
  const Timer whole;
  options.model = modelName(options);
  const Model model = stage(ExitCode::model, [&] { return Model(resolveModel(options.model)); });
  Frame frame = stage(ExitCode::input, [&] {
    Frame read(options.color, options.aux, options.layers, model.auxiliaryInputs());
    if (read.scale() != 0 && read.scale() != static_cast<int>(model.scale()))
      throw Error("The auxiliary images are " + std::to_string(read.scale()) + " times the colour's size, but model '" +
                  options.model + "' upscales by " + std::to_string(model.scale()) + ".");
    read.load();
    return read;
  });
  for (const std::string& warning : frame.warnings()) std::fprintf(stderr, "xrds: warning: %s\n", warning.c_str());
  Device device = stage(ExitCode::device, [&] { return Device({.select = options.device}); });
  if (options.check) runCheck(device, model, frame, options);

  const uint32_t scale = model.scale();
  Image result(static_cast<int>(frame.width() * scale), static_cast<int>(frame.height() * scale), 3);
  double seconds = 0;
  uint64_t deviceBytes = 0;
  float exposure = 0;
  stage(ExitCode::device, [&] {
    Upscaler upscaler(device, model, frame.width(), frame.height(), options.upscaler());
    ProgressBar bar(options.quiet);
    const Timer compute;
    const auto aux = viewsOf(frame.auxiliary());
    if (!upscaler.run(viewOf(frame.colour()), aux, result.pixels, [&](double share) { return bar.update(share); }))
      throw Failure{ExitCode::interrupted, "Interrupted; nothing was written."};
    seconds = compute.seconds();
    deviceBytes = upscaler.deviceBytes();
    exposure = upscaler.exposure();
    if (options.profile) printProfile(upscaler.profile());
  });
  const Image full = frame.alpha() ? withAlpha(result, stage(ExitCode::device, [&] {
                       return upscaleAlpha(device, *frame.alpha(), static_cast<int>(scale));
                     }))
                                   : result;
  if (interrupted()) throw Failure{ExitCode::interrupted, "Interrupted; nothing was written."};
  writeResult(options, frame, model, full, result);
  if (!options.quiet)
    std::printf("%s: %d x %d, model %s (%s), exposure %.4g, on %s: %.2f s of compute, %.1f MB of device memory, %.2f s in all\n",
                options.output.c_str(), result.width, result.height, options.model.c_str(), options.precision.c_str(),
                exposure, device.description().name.c_str(), seconds, static_cast<double>(deviceBytes) / 1e6, whole.seconds());
  if (!options.sideBySide.empty())
    stage(ExitCode::output, [&] {
      writeSideBySide(device, model, frame, result, options.reference, options.sideBySide);
    });
  if (!options.reference.empty())
    stage(ExitCode::input, [&] { printAgainstReference(device, model, frame, result, options.reference); });
}

}  // namespace

void addUpscale(CLI::App& app) {
  const auto options = std::make_shared<UpscaleOptions>();
  CLI::App* verb = app.add_subcommand("upscale", "Upscale one frame");
  verb->add_option("COLOR", options->color, "EXR file with the low-resolution colour, many samples a pixel")->required();
  verb->add_option("AUX", options->aux, "EXR file with full-resolution albedo and normal; without it they are in COLOR");
  verb->add_option("-o,--output", options->output, "EXR file to write: R, G, B (and A), 32-bit float, ZIP")->required();
  verb->add_option("--model", options->model, "A shipped model's name or a .safetensors file (default: the compact one of the scale)");
  verb->add_option("--precision", options->precision, "Storage of activations and weights")->check(CLI::IsMember({"fp32", "fp16"}))->capture_default_str();
  verb->add_option("--exposure", options->exposure, "Factor that brings the colour to a mean log luminance of 0.18")->check(CLI::Validator(validExposure, "auto|E"))->capture_default_str();
  verb->add_option("--device", options->device, "Number, part of the name, or UUID (see xrds devices)");
  verb->add_option("--color", options->layers.color, "Layer to take as colour")->type_name("LAYER");
  verb->add_option("--albedo", options->layers.albedo, "Layer to take as albedo")->type_name("LAYER");
  verb->add_option("--normal", options->layers.normal, "Layer to take as normal")->type_name("LAYER");
  verb->add_option("--reference", options->reference, "EXR file to compare with: prints metrics beside the baselines");
  verb->add_option("--preview", options->preview, "PNG file to write as well, with the sRGB curve");
  verb->add_option("--side-by-side", options->sideBySide, "PNG file with input, bicubic, result and reference side by side");
  verb->add_flag("--half", options->half, "Write 16-bit half floats");
  verb->add_flag("--profile", options->profile, "Print the device time of every operator");
  verb->add_flag("--check", options->check, "First compare each operator with its double-precision reference, on a crop");
  verb->add_flag("--quiet", options->quiet, "Print nothing but warnings and what was asked for");
  verb->footer("Layers are found by the naming of Cycles, pbrt, Mitsuba, Arnold, RenderMan, LuxCore and plain names;\n"
               "the options above choose one where that fails. The scale follows from the two sizes.\n\nExamples:\n"
               "  xrds upscale color.exr aux.exr -o out.exr\n"
               "  xrds upscale color.exr aux.exr -o out.exr --model my.safetensors --precision fp16 --preview out.png\n"
               "  xrds upscale multilayer.exr -o out.exr --albedo 'ViewLayer.Denoising Albedo'");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
