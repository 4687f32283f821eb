#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "app/byte_count.h"
#include "app/frame.h"
#include "app/models.h"
#include "app/skip_bound.h"
#include "app/skip_map.h"
#include "app/stage.h"
#include "cli/alpha.h"
#include "cli/commands.h"
#include "cli/device_choice.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "image/png_write.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

struct UpscaleOptions {
  std::string color, aux, output, model, device, reference, preview, sideBySide,
      precision = "fp32", exposure = "auto", memory, tiles = "bounded", skip = "off", skipMap;
  AovRequest layers;
  uint32_t ensemble = 1;
  bool half = false, profile = false, check = false, quiet = false, wrap = false;

  Upscaler::Options upscaler() const {
    Upscaler::Options options{.fp16 = precision == "fp16", .profile = profile};
    if (exposure != "auto") options.exposure = std::strtof(exposure.c_str(), nullptr);
    options.tiles = {.memoryBytes = parseBytes(memory), .exact = tiles == "exact", .wrap = wrap};
    options.skip.bound = parseSkip(skip);
    options.ensemble = ensemble;
    return options;
  }
};

struct Timer {
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); }
};

/// The model of a run and the file it came from.
struct OpenedModel {
  fs::path file;
  Model model;
  std::string name() const { return file.stem().string(); }
};

/// What a run computed, and how.
struct Upscaled {
  Image colour;
  float exposure = 0;
  double seconds = 0;
  uint64_t deviceBytes = 0;
  Tiling tiling{};
  SkipMap skipped{};
};

std::string validExposure(const std::string& text) {
  if (text == "auto") return {};
  char* end = nullptr;
  const float value = std::strtof(text.c_str(), &end);
  return *end == 0 && value > 1e-30F && value < 1e30F ? "" : "expected auto or a positive number, found '" + text + "'";
}

// Everything that can be known to fail is asked for before the long computation.
void checkOutputs(const UpscaleOptions& options) {
  requireExtension(options.output, ".exr", "--output");
  if (!options.preview.empty()) requireExtension(options.preview, ".png", "--preview");
  if (!options.sideBySide.empty()) requireExtension(options.sideBySide, ".png", "--side-by-side");
  if (!options.skipMap.empty()) requireExtension(options.skipMap, ".png", "--skip-map");
  if (!options.preview.empty() && options.preview == options.sideBySide)
    throw Failure{ExitCode::usage, "--preview and --side-by-side name the same file '" + options.preview + "'."};
  for (const std::string& path : {options.output, options.preview, options.sideBySide, options.skipMap})
    if (!path.empty()) requireWritable(path);
}

void printWarnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) std::fprintf(stderr, "xrds: warning: %s\n", warning.c_str());
}

constexpr const char* kColourAlone = "\n  or, of the colour alone: --model xrds-x4-compact-plain";

fs::path modelFile(const UpscaleOptions& options) {
  if (!options.model.empty()) return stage(ExitCode::model, [&] { return resolveModel(options.model); });
  const ExrFile file =
      stage(ExitCode::input, [&] { return readExrHeader(options.aux.empty() ? options.color : options.aux); });
  int scale = 0;
  try {
    scale =
        stage(ExitCode::input, [&] { return Frame(options.color, options.aux, options.layers, {"albedo"}).scale(); });
  } catch (Failure& failure) {
    if (options.layers.albedo.empty() && !hasAov(file, AovRole::kAlbedo)) failure.message += kColourAlone;
    throw;
  }
  const bool hasNormal = !options.layers.normal.empty() || hasAov(file, AovRole::kNormal);
  const fs::path model = stage(ExitCode::model, [&] { return defaultModel(scale, hasNormal); });
  if (!hasNormal)
    printWarnings({"'" + file.path.string() + "' has no normal; taking model " + model.stem().string() + "."});
  return model;
}

OpenedModel openModel(const UpscaleOptions& options) {
  const fs::path file = modelFile(options);
  OpenedModel opened{file, stage(ExitCode::model, [&] { return Model(file); })};
  stage(ExitCode::model, [&] { requireKnownInputs(opened.model, opened.name()); });
  return opened;
}

Frame openFrame(const UpscaleOptions& options, const OpenedModel& opened) {
  Frame frame = stage(ExitCode::input, [&] {
    return Frame(options.color, options.aux, options.layers, opened.model.auxiliaryInputs());
  });
  const int scale = static_cast<int>(opened.model.scale());
  if (frame.scale() != 0 && frame.scale() != scale)
    throw Failure{ExitCode::model, "The auxiliary images have " + std::to_string(frame.scale()) +
                                       " times the colour's size, but model '" + opened.name() + "' upscales by " +
                                       std::to_string(scale) + ": choose another with --model."};
  stage(ExitCode::input, [&] {
    (void)frame.output(scale);  // throws if the windows do not fit
    frame.load();
  });
  return frame;
}

void checkSkip(const UpscaleOptions& options, const OpenedModel& opened) {
  if (parseSkip(options.skip) == 0) return;
  if (const std::string why = opened.model.whyNeverSkipped(); !why.empty())
    throw Failure{ExitCode::model, "--skip is refused: model '" + opened.name() + "' " + why + "."};
  if (options.wrap)
    throw Failure{ExitCode::usage, "--skip and --wrap exclude each other: a panorama is computed in full."};
}

bool isConstant(const Image& image) {
  const auto channels = static_cast<size_t>(image.channels);
  for (size_t i = channels; i < image.pixels.size(); ++i)
    if (image.pixels[i] != image.pixels[i - channels]) return false;
  return true;
}

// A layer that is the same everywhere tells nothing: the model that does without it is taken, where one is shipped.
void leaveConstantsOut(const UpscaleOptions& options, OpenedModel& opened, Frame& frame) {
  const auto scale = static_cast<int>(opened.model.scale());
  const auto constant = [&](const char* input) {
    const auto found = std::find(frame.inputs().begin(), frame.inputs().end(), input);
    return found != frame.inputs().end() && isConstant(frame.auxiliary()[found - frame.inputs().begin()]);
  };
  const std::string input = constant("albedo") ? "albedo" : constant("normal") ? "normal" : "";
  if (input.empty()) return;
  const fs::path file = shippedVariant(scale, input == "albedo" ? "plain" : "albedo");
  if (file.empty()) return;
  opened = {file, stage(ExitCode::model, [&] { return Model(file); })};
  frame = openFrame(options, opened);
  printWarnings({"The " + input + " is the same everywhere; taking model " + opened.name() + "."});
}

void runCheck(Device& device, const Model& model, const Frame& frame, const UpscaleOptions& options) {
  const auto rows = stage(ExitCode::device, [&] { return checkOnCrop(device, model, frame, options.upscaler()); });
  const int divergent = printCheck(rows);
  if (divergent >= 0)
    throw Failure{ExitCode::differs,
                  "The device diverges from the reference, first at operator '" + rows[divergent].label + "'."};
}

Upscaled compute(Device& device, const Model& model, const Frame& frame, const UpscaleOptions& options) {
  const int scale = static_cast<int>(model.scale());
  Upscaled result{Image(frame.colour().width * scale, frame.colour().height * scale, 3)};
  Upscaler upscaler(device, model, frame.width(), frame.height(), options.upscaler());
  stopIfInterrupted();
  const Timer timer;
  {
    ProgressBar bar(options.quiet);
    const auto auxiliary = inputsOf(model, frame);
    upscaler.run(viewOf(frame.colour()), auxiliary, result.colour.pixels,
                 [&](double share) { return bar.update(share); });
  }
  stopIfInterrupted();
  result.seconds = timer.seconds();
  result.deviceBytes = upscaler.deviceBytes();
  result.exposure = upscaler.exposure();
  result.tiling = upscaler.tiling();
  result.skipped = upscaler.skipMap();
  if (options.profile) printProfile(upscaler.profile());
  if (const uint64_t count = upscaler.repairs().output; count > 0)
    printWarnings({"the network gave " + std::to_string(count) +
                   " pixels that were not finite: they show the base image without it" +
                   (options.precision == "fp16" ? "; --precision fp32 has a larger range." : ".")});
  return result;
}

// ", 61 % of the windows skipped", or nothing if none may be.
std::string skipText(const UpscaleOptions& options, const SkipMap& map) {
  if (parseSkip(options.skip) == 0) return "";
  char text[64];
  std::snprintf(text, sizeof text, ", %.0f %% of the windows skipped", 100 * map.share(SkipMap::Window::interpolated));
  return text;
}

// " in 6 tiles", or nothing for a frame in one piece.
std::string tilesText(const Tiling& tiling) {
  const uint32_t count = tiling.columns * tiling.rows;
  return count == 1 ? "" : " in " + std::to_string(count) + " tiles";
}

void writeResult(const UpscaleOptions& options, const Frame& frame, const OpenedModel& opened, const Upscaled& result,
                 const std::optional<Image>& alpha) {
  char exposure[32];
  std::snprintf(exposure, sizeof exposure, "%.6g", result.exposure);
  stage(ExitCode::output, [&] {
    ExrOutput output = frame.output(static_cast<int>(opened.model.scale()));
    output.texts["xrds:version"] = XRDS_VERSION;
    output.texts["xrds:model"] = opened.name() + " " + opened.model.hash();
    output.texts["xrds:options"] =
        "precision=" + options.precision + " exposure=" + exposure + (options.exposure == "auto" ? " (auto)" : "");
    if (options.ensemble > 1) output.texts["xrds:options"] += " ensemble=" + std::to_string(options.ensemble);
    output.pixelType = options.half ? ExrPixelType::kHalf : ExrPixelType::kFloat;
    writeExr(options.output, alpha ? withAlpha(result.colour, *alpha) : result.colour, output);
    if (!options.preview.empty()) writePng(options.preview, result.colour);
    if (!options.skipMap.empty()) writeSkipMap(options.skipMap, result.colour, result.skipped);
  });
}

/// All that is known before a device is needed.
struct Task {
  const UpscaleOptions& options;
  const OpenedModel& opened;
  const Frame& frame;
  const std::optional<Image>& reference;
  Timer whole;
};

void upscaleOn(Device& device, const Task& task) {
  const auto& [options, opened, frame, reference, whole] = task;
  const int scale = static_cast<int>(opened.model.scale());
  std::optional<EndsAtOnce> endsAtOnce(std::in_place);
  if (options.check) runCheck(device, opened.model, frame, options);
  const Upscaled result = compute(device, opened.model, frame, options);
  std::optional<Image> alpha;
  if (frame.alpha()) alpha = upscaleAlpha(device, *frame.alpha(), scale, options.upscaler().tiles);
  endsAtOnce.reset();
  writeResult(options, frame, opened, result, alpha);
  if (!options.quiet)
    std::printf(
        "%s: %d x %d%s%s, model %s (%s), exposure %.4g, on %s: %.2f s of compute, %.1f MB of device memory, %.2f s in "
        "all\n",
        options.output.c_str(), result.colour.width, result.colour.height, tilesText(result.tiling).c_str(),
        skipText(options, result.skipped).c_str(), opened.name().c_str(), options.precision.c_str(), result.exposure,
        device.description().name.c_str(), result.seconds, static_cast<double>(result.deviceBytes) / 1e6,
        whole.seconds());
  if (!options.sideBySide.empty()) writeSideBySide(device, frame, result.colour, reference, options.sideBySide);
  if (reference) printAgainstReference(device, frame, result.colour, *reference);
}

void run(const UpscaleOptions& options) {
  const Timer whole;
  checkOutputs(options);
  OpenedModel opened = openModel(options);
  Frame frame = openFrame(options, opened);
  if (options.model.empty()) leaveConstantsOut(options, opened, frame);
  checkSkip(options, opened);
  if (options.wrap && options.ensemble == 8)
    throw Failure{ExitCode::usage, "--ensemble 8 and --wrap exclude each other: 4 leaves out the diagonal."};
  const int scale = static_cast<int>(opened.model.scale());
  std::optional<Image> reference;
  if (!options.reference.empty())
    reference = stage(ExitCode::input, [&] {
      return readReference(options.reference, scale * frame.colour().width, scale * frame.colour().height);
    });
  printWarnings(frame.warnings());
  stopIfInterrupted();
  const Task task{options, opened, frame, reference, whole};
  onDevice(options.device, options.quiet, [&](Device& device) { upscaleOn(device, task); });
}

}  // namespace

void addUpscale(CLI::App& app) {
  const auto options = std::make_shared<UpscaleOptions>();
  CLI::App* verb = app.add_subcommand("upscale", "Upscale one frame");
  verb->add_option("COLOR", options->color, "EXR file with the low-resolution colour, many samples a pixel")
      ->required();
  verb->add_option("AUX", options->aux,
                   "EXR file with full-resolution albedo, normal and depth (default: they are in COLOR)");
  verb->add_option("-o,--output", options->output, "EXR file to write: R, G, B (and A), 32-bit float, ZIP")
      ->required()
      ->type_name("EXR");
  verb->add_option("--model", options->model,
                   "A shipped model's name or a .safetensors file (default: the compact one of the scale)")
      ->type_name("MODEL");
  verb->add_option("--precision", options->precision, "Storage of activations and weights")
      ->check(CLI::IsMember({"fp32", "fp16"}))
      ->capture_default_str();
  verb->add_option("--ensemble", options->ensemble,
                   "Passes whose mean is taken: 2, also turned by half a turn; 4, mirrored both ways; 8, also on the "
                   "diagonal. Better, and as many times slower; normals must be in the camera's axes")
      ->check(CLI::IsMember({1, 2, 4, 8}))
      ->capture_default_str();
  verb->add_option("--exposure", options->exposure, "Factor that brings the colour to a mean log luminance of 0.18")
      ->check(CLI::Validator(validExposure, "auto|E"))
      ->capture_default_str();
  verb->add_option(
          "--memory", options->memory,
          "Device memory to use at most, such as 256M or 2G (default: three quarters of what the device has); a "
          "frame that needs more is cut into tiles")
      ->check(CLI::Validator(validBytes, "BYTES"));
  verb->add_option("--tiles", options->tiles,
                   "exact: the picture is that of the whole frame bit for bit; bounded: a smaller halo, less work")
      ->check(CLI::IsMember({"exact", "bounded"}))
      ->capture_default_str();
  verb->add_option("--skip", options->skip,
                   "Interpolate windows without the network where that changes them by at most N, root mean square of\n"
                   "log(1 + exposure radiance): background, clear sky, even surfaces; safe: N = 0.005, off: none")
      ->check(CLI::Validator(validSkip, "off|safe|N"))
      ->capture_default_str();
  verb->add_option("--skip-map", options->skipMap, "PNG file with the picture, what was skipped dark and red")
      ->type_name("PNG");
  verb->add_flag("--wrap", options->wrap, "The left and right edges continue into each other: a panorama");
  verb->add_option("--device", options->device, "Number, part of the name, or UUID (see xrds devices)")
      ->type_name("DEVICE");
  verb->add_option("--color", options->layers.color, "Layer to take as colour")->type_name("LAYER");
  verb->add_option("--albedo", options->layers.albedo, "Layer to take as albedo")->type_name("LAYER");
  verb->add_option("--normal", options->layers.normal, "Layer to take as normal")->type_name("LAYER");
  verb->add_option("--depth", options->layers.depth, "Layer to take as depth, distances in any unit")
      ->type_name("LAYER");
  verb->add_option("--reference", options->reference, "EXR file to compare with: prints metrics beside the baselines")
      ->type_name("EXR");
  verb->add_option("--preview", options->preview, "PNG file to write as well, with the sRGB curve")->type_name("PNG");
  verb->add_option("--side-by-side", options->sideBySide,
                   "PNG file with input, bicubic, result and reference side by side")
      ->type_name("PNG");
  verb->add_flag("--half", options->half, "Write 16-bit half floats");
  verb->add_flag("--profile", options->profile, "Print the device time of every operator");
  verb->add_flag("--check", options->check,
                 "First compare each operator with its double-precision reference, on a crop");
  verb->add_flag("--quiet", options->quiet, "Print nothing but warnings and what was asked for");
  verb->footer(
      "The output keeps the attributes of COLOR and its windows, scaled. It is written under a temporary name and\n"
      "renamed, so it may replace COLOR or AUX. Layers are found by the naming of Cycles, pbrt, Mitsuba, Arnold,\n"
      "RenderMan, LuxCore and plain names; --color, --albedo, --normal and --depth choose others. The scale follows\n"
      "from the two sizes.\n\nExamples:\n"
      "  xrds upscale color.exr aux.exr -o out.exr\n"
      "  xrds upscale color.exr aux.exr -o out.exr --model my.safetensors --precision fp16 --preview out.png\n"
      "  xrds upscale multilayer.exr -o out.exr --albedo 'ViewLayer.Denoising Albedo'");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
