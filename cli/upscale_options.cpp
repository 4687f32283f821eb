#include "cli/upscale_options.h"

#include <CLI/CLI.hpp>
#include <utility>

#include "app/byte_count.h"
#include "app/exit_code.h"
#include "app/layer_options.h"
#include "app/number_pair.h"
#include "app/skip_bound.h"
#include "cli/common_options.h"
#include "cli/output_file.h"

namespace xrds {
namespace {

void addFiles(CLI::App& verb, UpscaleOptions& options) {
  verb.add_option("COLOR", options.color,
                  "EXR file with the low-resolution colour, many samples a pixel; this and AUX in any order")
      ->required();
  verb.add_option("AUX", options.aux,
                  "EXR file with full-resolution albedo, normal and depth (default: they are in COLOR)");
  verb.add_option("-o,--output", options.output, "EXR file to write: R, G, B (and A), 32-bit float, ZIP")
      ->required()
      ->type_name("EXR");
  verb.add_option("--reference", options.reference, "EXR file to compare with: prints metrics beside the baselines")
      ->type_name("EXR");
  verb.add_option("--preview", options.preview, "PNG file to write as well, with the sRGB curve")->type_name("PNG");
  verb.add_option("--side-by-side", options.sideBySide,
                  "PNG file with input, bicubic, result and reference side by side")
      ->type_name("PNG");
}

void addNetwork(CLI::App& verb, UpscaleOptions& options) {
  verb.add_option("--model", options.model,
                  "A shipped model's name or a .safetensors file (default: by the scale, the layers that are there, "
                  "and the samples)")
      ->type_name("MODEL");
  verb.add_flag(
      "--denoise-first", options.denoiseFirst,
      "Open Image Denoise takes the noise out of all images before the network sees them: better where they have\n"
      "few samples. Its networks run on the device where xrds import oidn has read them, else the installed library\n"
      "is called, which $XRDS_OIDN names if the system does not find it");
  verb.add_option("--denoise-by", options.denoiseBy,
                  "With --denoise-first: networks that were imported, the installed library, or auto, as above")
      ->check(CLI::IsMember({"auto", "networks", "library"}))
      ->needs("--denoise-first")
      ->capture_default_str();
  verb.add_option("--denoisers", options.denoisers,
                  "With --denoise-first: the folder with the networks (default: where xrds import oidn puts them)")
      ->type_name("FOLDER")
      ->needs("--denoise-first");
  verb.add_flag("--clean-guides", options.cleanGuides,
                "With --denoise-first: albedo and normal have no noise, as those of a rasterizer, and stay as they are")
      ->needs("--denoise-first");
  addPrecision(verb, options.precision);
  addEnsemble(verb, options.ensemble, ". So many of the denoiser, too");
  addExposure(verb, options.exposure);
  addDevice(verb, options.device);
  verb.add_option(
          "--tune", options.tune,
          "Find the fastest kernels of the device first, as xrds tune does: never, now, or auto, where a frame\n"
          "takes a minute and more. What was found before is used in any case")
      ->check(CLI::IsMember({"never", "auto", "now"}))
      ->capture_default_str();
}

void addParts(CLI::App& verb, UpscaleOptions& options) {
  verb.add_option(
          "--memory", options.memory,
          "Device memory to use at most, such as 256M or 2G (default: three quarters of what the device has); a "
          "frame that needs more is cut into tiles")
      ->check(CLI::Validator(validBytes, "BYTES"));
  addTiles(verb, options.tiles);
  verb.add_option("--skip", options.skip,
                  "Interpolate windows without the network where that changes them by at most N, root mean square of\n"
                  "log(1 + exposure radiance): background, clear sky, even surfaces; safe: N = 0.005, off: none")
      ->check(CLI::Validator(validSkip, "off|safe|N"))
      ->capture_default_str();
  verb.add_option("--skip-map", options.skipMap, "PNG file with the picture, what was skipped dark and red")
      ->type_name("PNG");
  addWrap(verb, options.wrap);
}

void addLayers(CLI::App& verb, UpscaleOptions& options) {
  addLayerOptions(verb, options.layers);
  addLights(
      verb, options.lights,
      "Layers of light to upscale as well, so that they still add up to the result: all (those that Cycles\n"
      "names, light groups too), or names with commas. Every other layer of AUX that is no light, such as depth,\n"
      "ids and Cryptomatte, is copied bit for bit");
  verb.add_option(
          "--aux-colour", options.auxColour,
          "Colour of the full-resolution render, which is merged into the low-resolution colour: auto (where the\n"
          "auxiliary file has one of the same light), never, or a layer")
      ->type_name("auto|never|LAYER")
      ->capture_default_str();
  verb.add_option(
          "--samples", options.samples,
          "Samples a pixel of the low- and the full-resolution render, for the weights of the merged colour and\n"
          "the choice of the model (default: the files' metadata, or an estimate from the noise). Where\n"
          "there is no full-resolution colour: with --aux-colour never")
      ->check(CLI::Validator(validPair, "LOW,HIGH"));
}

void addReports(CLI::App& verb, UpscaleOptions& options) {
  verb.add_option("--json", options.json, "File to write with every number of the run")->type_name("JSON");
  addQuiet(verb, options.quiet);
  verb.add_flag("--half", options.half, "Write 16-bit half floats");
  verb.add_flag("--profile", options.profile, "Print the device time of every operator");
  verb.add_flag("--check", options.check, "First compare each operator with its double-precision reference, on a crop");
}

}  // namespace

void addSequenceOptions(CLI::App& verb, UpscaleOptions& options) {
  verb.add_option("--frames", options.frames,
                  "Of a sequence: 1-240, 1-240:2 or 1-3,7,10-20:5 (default: those whose COLOR is there)")
      ->check([](const std::string& text) { return std::string(text.empty() ? "'' names no frames" : ""); })
      ->type_name("FRAMES");
  verb.add_flag("--skip-existing", options.skipExisting,
                "Leave frames out whose output is there: goes on where a run ended");
  verb.add_flag(
      "--temporal", options.temporal,
      "Merge each frame with those around it, along the motion that Cycles' pass Vector tells: less flicker,\n"
      "less noise");
  for (CLI::Option* option : addTemporal(verb, options.temporalRadius, options.motion)) option->needs("--temporal");
  verb.add_option("--devices", options.devices, "Devices that share the frames: all, or numbers with commas")
      ->check([](const std::string& text) { return std::string(text.empty() ? "'' names no device" : ""); })
      ->type_name("all|N,N")
      ->excludes("--device");
  verb.add_option("--jobs-per-device", options.jobsPerDevice, "Frames that a device computes at once")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  verb.add_option("--log", options.log, "File to write with what became of each frame, anew every few seconds")
      ->type_name("JSON");
}

Upscaler::Options UpscaleOptions::upscaler() const {
  Upscaler::Options options{.fp16 = precision == kFp16, .exposure = parseExposure(exposure), .profile = profile};
  options.tiles = {.memoryBytes = parseBytes(memory), .exact = tiles == "exact", .wrap = wrap};
  options.skip = {.bound = parseSkip(skip), .keepUnchanged = keepUnchanged};
  options.ensemble = ensemble;
  options.denoisedColour = denoiseFirst;
  options.tune = Upscaler::Tune::never;  // what there is to tune is tuned before
  return options;
}

void addUpscaleOptions(CLI::App& verb, UpscaleOptions& options) {
  addFiles(verb, options);
  addNetwork(verb, options);
  addParts(verb, options);
  addLayers(verb, options);
  addReports(verb, options);
  addSequenceOptions(verb, options);
  verb.add_flag(
      "--keep-unchanged", options.keepUnchanged,
      "Of a sequence: compute only windows that differ from the frame before. Needs --exposure E, so that the result "
      "does not\ndepend on which frame was before");
  verb.footer(
      "The output keeps the attributes of COLOR and its windows, scaled; xrds:version, xrds:model, xrds:options\n"
      "and, with --denoise-first, xrds:denoiser say what made it. It is written under a temporary name and\n"
      "renamed, so it may replace COLOR or AUX. Layers are found by the naming of Cycles, pbrt, Mitsuba,\n"
      "Arnold, RenderMan, LuxCore, Karma, Redshift, V-Ray and plain names; --color, --albedo, --normal and\n"
      "--depth choose others. A colour or albedo of channel Y alone is grey. The scale follows from the two sizes.\n"
      "Without --model a colour of at most 4 samples a pixel is upscaled by xrds-x4-live or xrds-x2-live, unless\n"
      "there is a full-resolution colour to merge. With --skip, which these refuse, the compact model is taken.\n\n"
      "Sequences: COLOR, AUX and --output with #### or %04d in their names, or folders of one numbered series; AUX may "
      "be one\nfile for all frames. The model is chosen by the first frame. A frame that fails is told and the others "
      "are "
      "made.\n\nExamples:\n"
      "  xrds upscale color.exr aux.exr -o out.exr\n"
      "  xrds upscale color.exr aux.exr -o out.exr --model my.safetensors --precision fp16 --preview out.png\n"
      "  xrds upscale multilayer.exr -o out.exr --albedo 'ViewLayer.Denoising Albedo'\n"
      "  xrds upscale beauty.####.exr guides.####.exr -o out/frame.####.exr --frames 1-240 --skip-existing");
}

void requireOutputs(const UpscaleOptions& options) {
  requireExtension(options.output, ".exr", "--output");
  if (!options.preview.empty()) requireExtension(options.preview, ".png", "--preview");
  if (!options.sideBySide.empty()) requireExtension(options.sideBySide, ".png", "--side-by-side");
  if (!options.skipMap.empty()) requireExtension(options.skipMap, ".png", "--skip-map");
  if (!options.json.empty()) requireExtension(options.json, ".json", "--json");
  const std::pair<const char*, std::string> pngs[] = {
      {"--preview", options.preview}, {"--side-by-side", options.sideBySide}, {"--skip-map", options.skipMap}};
  for (const auto& [first, path] : pngs)
    for (const auto& [second, other] : pngs)
      if (&path < &other && !path.empty() && path == other)
        throw Failure{ExitCode::usage, std::string(first) + " and " + second + " name the same file '" + path + "'."};
  for (const std::string& path : {options.output, options.preview, options.sideBySide, options.skipMap, options.json})
    if (!path.empty()) requireWritable(path);
}

}  // namespace xrds
