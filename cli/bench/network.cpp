#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>

#include "app/failing_with.h"
#include "app/models.h"
#include "cli/bench/network_report.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/output_file.h"
#include "cli/progress.h"

namespace xrds {
namespace {

struct BenchNetworkOptions {
  std::vector<std::string> devices, models, precisions{kFp32, kFp16}, families;
  std::vector<uint32_t> sides{256, 512, 1024};
  std::string scenes, json;
  int runs = 5, colour = 64, aux = 16;
  bool noCheck = false, quiet = false;
};

// The devices that were asked for, each once; cases know them by UUID.
std::vector<Device::Description> devicesOf(const BenchNetworkOptions& options) {
  std::vector<Device::Description> devices;
  const auto add = [&](const Device::Description& device) {
    if (std::none_of(devices.begin(), devices.end(), [&](const auto& known) { return known.uuid == device.uuid; }))
      devices.push_back(device);
  };
  const auto asked = options.devices.empty() ? std::vector<std::string>{""} : options.devices;
  for (const std::string& name : asked) {
    if (name != "all") {
      add(Device({.select = name}).description());
      continue;
    }
    for (const Device::Description& device : Device::list()) add(device);
    if (devices.empty()) add(Device().description());  // throws: there is none
  }
  return devices;
}

std::vector<NamedModel> modelsOf(const BenchNetworkOptions& options) {
  auto asked = options.models.empty() ? std::vector<std::string>{defaultModelName(4)} : options.models;
  if (const auto all = std::find(asked.begin(), asked.end(), "all"); all != asked.end()) {
    const auto shipped = shippedModels();
    asked.insert(asked.erase(all), shipped.begin(), shipped.end());
  }
  std::vector<NamedModel> models;
  std::set<std::string> names;
  for (const std::string& name : asked) {
    const std::filesystem::path file = resolveModel(name);
    if (!names.insert(file.stem().string()).second)
      throw Failure{ExitCode::usage, "Two models have the name '" + file.stem().string() + "': name each once."};
    models.push_back({file.stem().string(), name, Model(file)});
  }
  return models;
}

void requireMultiples(const BenchNetworkOptions& options, const std::vector<NamedModel>& models) {
  for (const NamedModel& model : models)
    for (const uint32_t side : options.sides)
      if (side % model.model.scale() != 0)
        throw Failure{ExitCode::usage, "--size " + std::to_string(side) + " is no multiple of the scale " +
                                           std::to_string(model.model.scale()) + " of model '" + model.name + "'."};
}

std::vector<NetworkCase> casesOf(const BenchNetworkOptions& options, const std::vector<NamedModel>& models,
                                 const std::vector<Device::Description>& devices) {
  std::vector<uint32_t> sides = options.sides;
  std::sort(sides.begin(), sides.end());  // memory that the allocator keeps must not come from a larger frame
  const auto families = options.families.empty() ? std::vector<std::string>{""} : options.families;
  std::vector<NetworkCase> cases;
  for (const auto& device : devices)
    for (const uint32_t side : sides)
      for (const NamedModel& model : models)
        for (const std::string& precision : options.precisions)
          for (const std::string& family : families) cases.push_back({device.uuid, precision, family, &model, side});
  return cases;
}

AccuracyRow accuracyOf(const BenchNetworkOptions& options, const NetworkCase& networkCase) {
  AccuracyRow row{networkCase};
  if (!options.noCheck) row.engine = engineError(networkCase);
  stopIfInterrupted();
  if (!options.scenes.empty())
    row.image =
        imageError(networkCase, options.scenes, settingFor(networkCase.model->model, options.colour, options.aux));
  return row;
}

NetworkReport measureAll(const BenchNetworkOptions& options, const std::vector<NetworkCase>& cases) {
  NetworkReport report{.runs = options.runs, .scenes = options.scenes};
  ProgressBar bar(options.quiet);
  std::set<std::string> known;
  for (const NetworkCase& networkCase : cases) {
    stopIfInterrupted();
    report.networks.push_back({networkCase, measureNetwork(networkCase, options.runs)});
    bar.update(static_cast<double>(report.networks.size()) / static_cast<double>(cases.size()));
  }
  if (options.noCheck && options.scenes.empty()) return report;
  for (const NetworkRow& row : report.networks) {
    const NetworkCase& networkCase = row.networkCase;
    if (row.measurement.kernelFamily.empty()) continue;  // the device did not open
    const std::string which = networkCase.device + networkCase.precision + networkCase.family;
    if (!known.insert(which + " " + networkCase.model->name).second) continue;
    stopIfInterrupted();
    report.accuracies.push_back(accuracyOf(options, networkCase));
  }
  return report;
}

void run(const BenchNetworkOptions& options) {
  requireOutput(options.json, ".json", "--json");
  const auto models = failingWith(ExitCode::model, [&] { return modelsOf(options); });
  requireMultiples(options, models);
  const auto devices = failingWith(ExitCode::device, [&] { return devicesOf(options); });
  const auto cases = casesOf(options, models, devices);
  NetworkReport report = failingWith(ExitCode::device, [&] { return measureAll(options, cases); });
  report.devices = devices;
  if (!options.quiet) std::fputs(plainText(report).c_str(), stdout);
  if (!options.json.empty()) failingWith(ExitCode::output, [&] { writeText(options.json, jsonText(report)); });
}

void addCases(CLI::App& verb, BenchNetworkOptions& options) {
  verb.add_option("--device", options.devices,
                  "Number, part of the name, or UUID (see xrds devices), or all; may be "
                  "repeated (default: the best one)")
      ->allow_extra_args(false)
      ->type_name("DEVICE");
  verb.add_option("--model", options.models,
                  "A shipped model's name, all of them, or a .safetensors file; may be repeated (default: "
                  "xrds-x4-compact)")
      ->allow_extra_args(false)
      ->type_name("MODEL");
  verb.add_option("--size", options.sides, "Sides of the square output in pixels, with commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(1, 65536))
      ->capture_default_str()
      ->type_name("N");
  verb.add_option("--precision", options.precisions, "Storage of activations and weights, with commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({kFp32, kFp16}))
      ->capture_default_str();
  verb.add_option("--family", options.families, "Kernels to compare, with commas (default: those that suit the device)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(Device::kernelFamilies()));
  verb.add_option("--runs", options.runs, "Frames that count, after the first one")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
}

}  // namespace

void addBenchNetwork(CLI::App& group) {
  const auto options = std::make_shared<BenchNetworkOptions>();
  CLI::App* verb = group.add_subcommand("network", "Time models on devices, with their memory and their errors");
  addCases(*verb, *options);
  verb->add_flag("--no-check", options->noCheck, "Leave out the comparison with the double-precision reference");
  verb->add_option("--scenes", options->scenes, "Folder of scenes for the image error, as bench quality takes it")
      ->type_name("FOLDER");
  addSceneSamples(*verb, options->colour, options->aux);
  addReportFile(*verb, options->json);
  addQuiet(*verb, options->quiet);
  verb->footer(
      "Every model runs on every device in every size and precision, on random pixels, each time on a device opened\n"
      "anew. A frame that a device refuses is reported with its reason. bench/report.py makes a page of the JSON.\n\n"
      "Examples:\n"
      "  xrds bench network\n"
      "  xrds bench network --family tile,matrix,fused\n"
      "  xrds bench network --device all --model all --size 256,512,1024,2048,4096 --json network.json\n"
      "  xrds bench network --model run/best.safetensors --precision fp16 --scenes val");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
