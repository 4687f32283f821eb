#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "app/failing_with.h"
#include "app/models.h"
#include "cli/bench/stress_report.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/output_file.h"
#include "cli/progress.h"

namespace xrds {
namespace {

struct BenchStressOptions {
  std::string device, json, markdown;
  std::vector<std::string> models;
  uint32_t seed = 1;
  bool shortForm = false, noRandom = false, quiet = false;
};

std::vector<std::string> modelNames(const BenchStressOptions& options) {
  if (options.shortForm && options.models.empty()) return {};
  std::vector<std::string> names;
  const auto asked = options.models.empty() ? std::vector<std::string>{"all"} : options.models;
  for (const std::string& name : asked) {
    if (name == "none") continue;
    const auto found = name == "all" ? shippedModels() : std::vector<std::string>{name};
    names.insert(names.end(), found.begin(), found.end());
  }
  return names;
}

void run(const BenchStressOptions& options) {
  requireOutput(options.json, ".json", "--json");
  requireOutput(options.markdown, ".md", "--markdown");
  const auto names = modelNames(options);
  std::vector<Model> models;
  for (const std::string& name : names)
    models.push_back(failingWith(ExitCode::model, [&] { return Model(resolveModel(name)); }));
  Device device = failingWith(ExitCode::device, [&] { return Device({.select = options.device}); });
  ProgressBar bar(options.quiet);
  StressOptions wanted{.randomModels = !options.noRandom,
                       .seed = options.seed,
                       .shortForm = options.shortForm,
                       .progress = [&](double share) { return bar.update(share); }};
  for (size_t i = 0; i < models.size(); ++i) wanted.models.push_back({names[i], &models[i]});
  const StressReport report = failingWith(ExitCode::device, [&] { return Upscaler::stress(device, wanted); });
  stopIfInterrupted();
  if (!options.quiet)
    std::printf("%s, %s\n%s", device.description().name.c_str(), device.description().driver.c_str(),
                plainText(report).c_str());
  failingWith(ExitCode::output, [&] {
    if (!options.json.empty()) writeText(options.json, jsonText(report));
    if (!options.markdown.empty()) writeText(options.markdown, markdownText(report));
  });
  if (const size_t count = report.exceptions().size(); count > 0)
    throw Failure{ExitCode::differs,
                  std::to_string(count) + " bars of the stress run are not met; they are listed above."};
}

}  // namespace

void addBenchStress(CLI::App& group) {
  const auto options = std::make_shared<BenchStressOptions>();
  CLI::App* verb = group.add_subcommand("stress", "Try hostile images and weights, against double precision");
  addDevice(*verb, options->device);
  verb->add_option("--model", options->models,
                   "A shipped model's name, all of them, none, or a .safetensors file; may be repeated (default: all)")
      ->allow_extra_args(false)
      ->type_name("MODEL");
  verb->add_option("--seed", options->seed, "Of the images and the random models")->capture_default_str();
  verb->add_flag("--short", options->shortForm,
                 "Nine random models, which have every operator, and no others but --model: a minute");
  verb->add_flag("--no-random", options->noRandom, "Leave out the random models")->excludes("--short");
  addReportFile(*verb, options->json);
  verb->add_option("--markdown", options->markdown, "File to write with the tables")->type_name("MD");
  addQuiet(*verb, options->quiet);
  verb->footer(
      "Tiny frames of every kind that breaks networks go through every model, also with weights scaled to the edge of\n"
      "what numbers hold, in both precisions and every kernel family. No output may hold a NaN or infinity, natural\n"
      "frames must be as exact as README.md says, and every operator keeps its budget; else the exit code is 7.\n\n"
      "Examples:\n"
      "  xrds bench stress --short\n"
      "  xrds bench stress --json stress.json\n"
      "  xrds bench stress --model run/best.safetensors --seed 2");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
