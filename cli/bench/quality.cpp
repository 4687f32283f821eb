#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <map>
#include <memory>
#include <set>

#include "app/denoiser.h"
#include "app/failing_with.h"
#include "app/models.h"
#include "app/network_denoiser.h"
#include "cli/bench/quality_report.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

struct BenchQualityOptions {
  std::string folder, aux = "16", precision = kFp32, device, json, markdown, write;
  std::optional<int> colour;
  int scale = 4;
  uint32_t ensemble = 1;
  bool quiet = false, merge = false, denoiseFirst = false, denoiser = false;
  std::vector<std::string> models, also;
};

/// All that takes part in a run.
struct Contest {
  QualitySetting setting;
  std::unique_ptr<Denoiser> denoiser;         // null: the methods see the noise
  std::unique_ptr<NetworkDenoiser> networks;  // null: they are no rival
  std::vector<EngineMethod> engine;
  std::vector<FinishedImages> finished;
  SceneList list;
};

std::string validAux(const std::string& text) {
  const bool number = !text.empty() && text.size() < 7 && text.find_first_not_of("0123456789") == std::string::npos;
  return text == "converged" || (number && std::stoi(text) > 0)
             ? ""
             : "expected a number of samples or converged, found '" + text + "'";
}

QualitySetting settingOf(const BenchQualityOptions& options) {
  QualitySetting setting{.scale = options.scale};
  if (options.aux != "converged") setting.auxSamples = std::stoi(options.aux);
  if (options.colour) {
    setting.colourSamples = *options.colour;
  } else if (options.scale == 1) {
    if (!setting.auxSamples)
      throw Failure{ExitCode::usage,
                    "At scale 1 with converged auxiliary images, --samples must say which render's "
                    "colour is taken: that of the references is what is looked for."};
    setting.colourSamples = *setting.auxSamples;
  }
  setting.mergesColour = options.merge;
  if (options.merge && (options.scale == 1 || !setting.auxSamples))
    throw Failure{ExitCode::usage,
                  "--merge needs a full-resolution render beside the low-resolution one: a --scale from "
                  "2 on, and a number of samples for --aux."};
  return setting;
}

std::vector<FinishedImages> finishedOf(const BenchQualityOptions& options) {
  std::vector<FinishedImages> finished;
  for (const std::string& text : options.also) {
    const size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
      throw Failure{ExitCode::usage, "--also takes NAME=FOLDER or NAME=PATTERN, found '" + text + "'."};
    finished.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return finished;
}

std::vector<EngineMethod> engineMethods(const BenchQualityOptions& options) {
  std::vector<EngineMethod> methods = untrainedMethods(options.scale);
  std::vector<std::string> models = options.models;
  if (models.empty()) {
    const std::string shipped = defaultModelName(options.scale);
    const auto all = shippedModels();
    if (std::find(all.begin(), all.end(), shipped) != all.end())
      models.push_back(shipped);
    else
      std::fprintf(stderr, "xrds: warning: There is no shipped model '%s'; only the untrained methods are measured.\n",
                   shipped.c_str());
  }
  for (const std::string& model : models) {
    methods.push_back(trainedMethod(model, options.scale));
    if (options.ensemble > 1) methods.push_back(trainedMethod(model, options.scale, options.ensemble));
  }
  return methods;
}

std::string rivalName(const Contest& contest) { return "Open Image Denoise, " + contest.setting.auxText() + " spp"; }

void requireDistinctNames(const Contest& contest) {
  std::set<std::string> names{"input"};
  const auto add = [&](const std::string& name) {
    if (!names.insert(name).second)
      throw Failure{ExitCode::usage, "Two methods have the name '" + name + "': rename one of them."};
  };
  for (const EngineMethod& method : contest.engine) add(method.name());
  if (contest.networks) add(rivalName(contest));
  for (const FinishedImages& images : contest.finished) add(images.name);
}

Contest prepare(const BenchQualityOptions& options) {
  Contest contest{settingOf(options), {}, {}, {}, finishedOf(options), {}};
  if (options.denoiser) {
    if (!contest.setting.auxSamples)
      throw Failure{ExitCode::usage, "--denoiser takes the colour of the full-resolution render: give --aux a number."};
    contest.networks = std::make_unique<NetworkDenoiser>(NetworkDenoiser::Options{
        .fp16 = options.precision == kFp16, .progress = [](double) { return !interrupted(); }});
    failingWith(ExitCode::model, [&] { contest.networks->load(2, false, true); });
  }
  if (options.denoiseFirst) {
    contest.denoiser = failingWith(ExitCode::device, [] { return std::make_unique<Denoiser>(); });
    contest.setting.denoisedBy = contest.denoiser->name();
  }
  contest.engine = failingWith(ExitCode::model, [&] { return engineMethods(options); });
  requireDistinctNames(contest);
  for (const EngineMethod& method : contest.engine) contest.setting.read(method.model());
  contest.list = failingWith(ExitCode::input,
                             [&] { return findScenes(pathOf(options.folder), contest.setting, contest.finished); });
  return contest;
}

// A file name for a method's image of a scene.
fs::path imageFile(const BenchQualityOptions& options, const std::string& scene, std::string method) {
  for (char& c : method)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '.') c = '_';
  return pathOf(options.write) / pathOf(scene + "_" + method + ".exr");
}

void writeImage(const BenchQualityOptions& options, const std::string& sceneName, const Frame& frame,
                const EngineMethod& method, const Image& image) {
  failingWith(ExitCode::output, [&] {
    ExrOutput output = frame.output(options.scale);
    output.texts["xrds:version"] = XRDS_VERSION;
    output.texts["xrds:model"] = method.name() + " " + method.model().hash();
    writeExr(imageFile(options, sceneName, method.name()), image, output);
  });
}

// What the methods see, by the passes of their ensemble, which are those of the denoiser, too.
std::map<uint32_t, Frame> framesFor(const Contest& contest, const Frame& noisy) {
  std::map<uint32_t, Frame> frames{{1, noisy}};
  for (const EngineMethod& method : contest.engine) frames.emplace(method.ensemble(), noisy);
  if (contest.denoiser)
    for (auto& entry : frames)
      failingWith(ExitCode::device,
                  [&] { entry.second.denoise(*contest.denoiser, !contest.setting.auxSamples, entry.first); });
  return frames;
}

// The full-resolution render with albedo and normal, which are denoised first.
SceneQuality measureRival(NetworkDenoiser& networks, Device& device, const SceneFiles& files, const Scene& scene) {
  Frame full(files.aux, {}, {}, {std::string(kAlbedo.name), std::string(kNormal.name)}, {.never = true});
  full.load();
  DeviceDenoiser denoiser(networks, device);
  const double before = networks.runSeconds();
  untilInterrupted([&] { full.denoise(denoiser, false); });
  return {measure(full.colour(), scene.reference), FrameSeconds{.wall = networks.runSeconds() - before}};
}

// Adds one scene to every method of the report; their order is that of reportFor.
void measureScene(const BenchQualityOptions& options, Contest& contest, const SceneFiles& files, Device& device,
                  QualityReport& report) {
  Scene scene = failingWith(ExitCode::input, [&] { return loadScene(files, contest.setting); });
  std::map<uint32_t, Frame> frames = framesFor(contest, scene.frame);
  for (const std::string& warning : scene.frame.warnings())
    std::fprintf(stderr, "xrds: warning: %s: %s\n", files.name.c_str(), warning.c_str());
  auto row = report.methods.begin();
  if (options.scale == 1) (row++)->scenes.push_back({measure(frames.at(1).colour(), scene.reference)});
  for (EngineMethod& method : contest.engine) {
    FrameSeconds seconds;
    const Frame& frame = frames.at(method.ensemble());
    const Image image = failingWith(ExitCode::device, [&] {
      return method.run(device, frame, options.precision == kFp16, options.denoiseFirst, seconds);
    });
    (row++)->scenes.push_back({measure(image, scene.reference), seconds});
    if (!options.write.empty()) writeImage(options, files.name, frame, method, image);
  }
  if (contest.networks)
    (row++)->scenes.push_back(
        failingWith(ExitCode::device, [&] { return measureRival(*contest.networks, device, files, scene); }));
  for (const Image& image : scene.finished) (row++)->scenes.push_back({measure(image, scene.reference)});
}

QualityReport reportFor(const BenchQualityOptions& options, const Contest& contest, const Device& device) {
  QualityReport report{
      options.folder, options.precision, device.description().name, contest.setting, {}, contest.list.skipped, {}};
  if (options.scale == 1) report.methods.push_back({"input"});
  for (const EngineMethod& method : contest.engine)
    report.methods.push_back({method.name(), method.trained() ? method.model().hash() : ""});
  if (contest.networks) report.methods.push_back({rivalName(contest)});
  for (const FinishedImages& images : contest.finished) report.methods.push_back({images.name});
  return report;
}

void checkOutputs(const BenchQualityOptions& options) {
  requireOutput(options.json, ".json", "--json");
  requireOutput(options.markdown, ".md", "--markdown");
  if (options.write.empty()) return;
  std::error_code error;
  fs::create_directories(pathOf(options.write), error);
  if (error)
    throw Failure{ExitCode::output, "Cannot make the folder '" + options.write + "': " + error.message() + "."};
  requireWritable((pathOf(options.write) / "image.exr").string());
}

// The contest is taken by value: its upscalers must go before the device.
QualityReport measureAll(const BenchQualityOptions& options, Contest contest, Device& device) {
  QualityReport report = reportFor(options, contest, device);
  ProgressBar bar(options.quiet);
  for (const SceneFiles& files : contest.list.scenes) {
    stopIfInterrupted();
    failingWith(ExitCode::input, [&] { measureScene(options, contest, files, device, report); });
    report.sceneNames.push_back(files.name);
    bar.update(static_cast<double>(report.sceneNames.size()) / static_cast<double>(contest.list.scenes.size()));
  }
  return report;
}

void run(const BenchQualityOptions& options) {
  Contest contest = prepare(options);
  checkOutputs(options);
  Device device = failingWith(ExitCode::device, [&] { return Device({.select = options.device}); });
  const QualityReport report = measureAll(options, std::move(contest), device);
  if (!options.quiet) std::fputs(plainText(report).c_str(), stdout);
  failingWith(ExitCode::output, [&] {
    if (!options.json.empty()) writeText(options.json, jsonText(report));
    if (!options.markdown.empty()) writeText(options.markdown, markdownText(report));
  });
}

void addFiles(CLI::App& verb, BenchQualityOptions& options) {
  verb.add_option("FOLDER", options.folder, "Folder of scenes NAME_gt.exr, NAME_lrK.exr, NAME_auxK.exr")->required();
  verb.add_option("--model", options.models,
                  "A shipped model's name or a .safetensors file; may be repeated (default: the compact one of the "
                  "scale)")
      ->allow_extra_args(false)
      ->type_name("MODEL");
  verb.add_option("--also", options.also,
                  "Finished images of another program, FOLDER/NAME*.exr, as a method of this name; may be repeated")
      ->allow_extra_args(false)
      ->type_name("METHOD=FOLDER");
  addReportFile(verb, options.json);
  verb.add_option("--markdown", options.markdown, "File to write with the tables")->type_name("MD");
  verb.add_option("--write", options.write, "Folder for the images, NAME_METHOD.exr")->type_name("FOLDER");
}

}  // namespace

void addBenchQuality(CLI::App& group) {
  const auto options = std::make_shared<BenchQualityOptions>();
  CLI::App* verb = group.add_subcommand("quality", "Compare models with their rivals on a folder of scenes");
  addFiles(*verb, *options);
  verb->add_option("--scale", options->scale, "Of the colour's render")
      ->check(CLI::IsMember({1, 2, 4, 8, 16}))
      ->capture_default_str();
  verb->add_option("--samples", options->colour,
                   "Samples a pixel of the colour (default: 64; at scale 1 those of --aux)")
      ->check(CLI::PositiveNumber)
      ->type_name("K");
  verb->add_option("--aux", options->aux, "Samples a pixel of albedo and normal, or converged: those of the reference")
      ->check(CLI::Validator(validAux, "K|converged"))
      ->capture_default_str();
  verb->add_flag("--merge", options->merge,
                 "Every method gets the merged colour: that of the full-resolution render is in it, by samples");
  verb->add_flag(
      "--denoise-first", options->denoiseFirst,
      "Open Image Denoise takes the noise out of all images before any method sees them, but for converged guides");
  verb->add_flag("--denoiser", options->denoiser,
                 "Also measure the full-resolution render of --aux samples, denoised by Open Image Denoise's networks "
                 "(xrds\nimport oidn) with its albedo and normal, which are denoised first");
  verb->add_option("--ensemble", options->ensemble, "Also measure each model as the mean of so many passes")
      ->check(CLI::IsMember({1, 2, 4, 8}))
      ->capture_default_str();
  addPrecision(*verb, options->precision);
  addDevice(*verb, options->device);
  addQuiet(*verb, options->quiet);
  verb->footer(
      "Scene NAME is NAME_gt.exr (the reference, with converged albedo and normal), the colour of K samples in\n"
      "NAME_lrK.exr (scale 4), NAME_x2lrK.exr or NAME_x8lrK.exr, and NAME_auxK.exr, the full-resolution render of K\n"
      "samples with albedo and normal, whose colour is the input of scale 1. Scenes without all files are skipped. In\n"
      "--also the place may be a pattern such as 'out/*_oidn4.exr', where * is the scene's name. Average samples are\n"
      "those of the colour over the square of the scale, plus those of the auxiliary images; one render for both\n"
      "counts once.\n\nExamples:\n"
      "  xrds bench quality val\n"
      "  xrds bench quality val --scale 2 --samples 16 --aux converged --markdown x2.md\n"
      "  xrds bench quality val --model run/best.safetensors --also 'OIDN 4 spp=denoised' --json x4.json");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
