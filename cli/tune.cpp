#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <utility>

#include "app/failing_with.h"
#include "app/models.h"
#include "app/pixel_size.h"
#include "app/timer.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/device_choice.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/tune_report.h"
#include "cli/warnings.h"

namespace xrds {
namespace {

struct TuneOptions {
  std::vector<std::string> models;
  std::vector<std::string> precisions{kFp32, kFp16};
  std::string size = "1920x1080", device, json;
  bool anew = false, quiet = false;
};

/// A device that is opened again after a kernel has lost it: such a kernel is struck off by then.
class ReopenedDevice {
 public:
  explicit ReopenedDevice(const TuneOptions& options) : options_(options) { open(); }
  Device& device() { return *device_; }

  /// Calls the work again on the device opened anew, as often as a kernel loses it.
  template <class Work>
  auto run(Work&& work) {
    constexpr int kMostTimes = 20;
    for (int times = 1;; ++times) try {
        return work(*device_);
      } catch (const DeviceLost& error) {
        if (times == kMostTimes) throw;
        std::fprintf(stderr, "xrds: warning: %s\n", error.what());
        open();
      }
  }

 private:
  void open() {
    device_.reset();
    device_ = std::make_unique<Device>(
        Device::Options{.select = options_.device, .onPreparation = [](const Preparation&) { return !interrupted(); }});
  }
  const TuneOptions& options_;
  std::unique_ptr<Device> device_;
};

TunedModel tuneModel(ReopenedDevice& reopened, const std::string& name, const Model& model, bool fp16, bool anew,
                     const TuneOptions& options) {
  const PixelSize size = parseOutputSize(options.size);
  const uint32_t scale = model.scale(), width = (size.width + scale - 1) / scale,
                 height = (size.height + scale - 1) / scale;
  TunedModel tuned{name, fp16, scale * width, scale * height};
  const Timer timer;
  if (!anew)
    if (auto known = Tuning::known(reopened.device(), model, width, height, fp16)) {
      tuned.report = std::move(*known);
      tuned.seconds = timer.seconds();
      return tuned;
    }
  ProgressBar bar(options.quiet);
  tuned.report = untilInterrupted([&] {
    return reopened.run([&](Device& device) {
      return Tuning::run(device, model, width, height,
                         {.fp16 = fp16,
                          .label = name,
                          .anew = std::exchange(anew, false),
                          .progress = [&](double share, const std::string&) { return bar.update(share); }});
    });
  });
  tuned.seconds = timer.seconds();
  return tuned;
}

void run(TuneOptions options) {
  requireOutput(options.json, ".json", "--json");
  parseOutputSize(options.size);
  if (options.models.empty()) options.models.push_back(defaultModelName(4));
  std::vector<std::pair<std::string, Model>> models;
  for (const std::string& name : options.models)
    models.emplace_back(name, failingWith(ExitCode::model, [&] { return Model(resolveModel(name)); }));
  std::vector<TunedModel> tuned;
  const auto device = failingWith(ExitCode::device, [&] {
    ReopenedDevice reopened(options);
    printNotes(reopened.device());
    bool anew = options.anew, warned = false;
    for (const auto& [name, model] : models)
      for (const std::string& precision : options.precisions) {
        tuned.push_back(tuneModel(reopened, name, model, precision == kFp16, std::exchange(anew, false), options));
        if (!options.quiet) std::fputs(tuneText(tuned.back()).c_str(), stdout);
        std::fflush(stdout);
        if (const std::string& unkept = tuned.back().report.unkept; !unkept.empty() && !std::exchange(warned, true))
          printWarnings({unkept + "."});
      }
    return reopened.device().description();
  });
  if (!options.json.empty()) failingWith(ExitCode::output, [&] { writeText(options.json, tuneJson(device, tuned)); });
}

}  // namespace

void addTune(CLI::App& app) {
  const auto options = std::make_shared<TuneOptions>();
  CLI::App* verb = app.add_subcommand("tune", "Find the fastest kernels of a device");
  verb->add_option("MODEL", options->models, "Shipped models' names or .safetensors files (default: xrds-x4-compact)");
  verb->add_option("--size", options->size,
                   "WIDTHxHEIGHT of the output; the winners serve frames of a quarter to four times as many pixels")
      ->capture_default_str();
  verb->add_option("--precision", options->precisions, "Storage of activations and weights, with commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({kFp32, kFp16}))
      ->capture_default_str();
  addDevice(*verb, options->device);
  verb->add_flag("--anew", options->anew,
                 "Forget what is known of the device, and what was struck off, and start anew");
  verb->add_option("--json", options->json, "File to write with every number")->type_name("JSON");
  addQuiet(*verb, options->quiet);
  verb->footer(
      "Each kernel that may make an operator of the model is compared with double precision and timed on the device;\n"
      "one that wins, in turns with the fixed choice and by more than noise, is used by all commands from then on.\n"
      "What was found is kept for the driver: a tuning that was interrupted goes on where it stopped, and a kernel "
      "that\n"
      "was wrong, hung or lost the device is not tried again.\n\nExamples:\n"
      "  xrds tune\n"
      "  xrds tune xrds-x4-full xrds-x2-live --size 3840x2160 --precision fp16");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
