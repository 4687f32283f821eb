#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "app/failing_with.h"
#include "app/models.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/device_choice.h"
#include "cli/doctor_report.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "xrds/tuning.h"

namespace xrds {
namespace {

struct DoctorOptions {
  std::string device, json;
  uint32_t runs = 3;
  bool quiet = false;
};

// A doctor should not need models: without one the question is left out.
std::optional<UsualFrame> usualFrame(const std::string& kernelFamily) {
  try {
    const std::string name = defaultModelName(4);
    const Model model(resolveModel(name));
    UsualFrame usual{name, 1920, 1080};
    const auto bytes = [&](bool fp16) {
      const Model::Cost cost = model.cost(usual.width, usual.height, fp16, kernelFamily);
      return cost.plannedBytes + cost.weightBytes;
    };
    usual.fp32Bytes = bytes(false);
    usual.fp16Bytes = bytes(true);
    return usual;
  } catch (const Error&) {
    return std::nullopt;
  }
}

Findings examine(Device& device, const DoctorOptions& options) {
  Findings findings{device.description(), Examination::capabilities(device), {}, {}, options.runs};
  findings.usual = usualFrame(findings.device.kernelFamily);
  findings.tuning = Tuning::summary(device);
  ProgressBar bar(options.quiet);
  for (const bool fp16 : {false, true}) {
    PrecisionExamination& precision = findings.precisions.emplace_back(PrecisionExamination{fp16});
    precision.kernels = Examination::kernels(device, fp16, options.runs);
    bar.update(fp16 ? 0.9 : 0.4);
    stopIfInterrupted();
    precision.frame = Examination::knownFrame(device, fp16, options.runs);
    bar.update(fp16 ? 1 : 0.5);
    stopIfInterrupted();
  }
  return findings;
}

void run(const DoctorOptions& options) {
  requireOutput(options.json, ".json", "--json");
  const Findings findings = failingWith(ExitCode::device, [&] {
    const EndsAtOnce endsAtOnce;
    Device device({.select = options.device});
    printNotes(device);
    return examine(device, options);
  });
  const Verdict verdict = judge(findings);
  if (!options.quiet) std::fputs(doctorText(findings, verdict).c_str(), stdout);
  if (!options.json.empty())
    failingWith(ExitCode::output, [&] { writeText(options.json, doctorJson(findings, verdict)); });
  if (verdict.code != ExitCode::ok) throw Failure{verdict.code, verdict.sentence};
}

}  // namespace

void addDoctor(CLI::App& app) {
  const auto options = std::make_shared<DoctorOptions>();
  CLI::App* verb = app.add_subcommand("doctor", "Examine whether a device computes what it should");
  verb->footer(
      "Runs every kernel with which the device works, and a small frame whose answer is known, several times in fp32\n"
      "and fp16; compares them with double precision and with themselves, and tells what the device lacks.\n"
      "Exit code 0: trusted; 7: wrong or changing results; 5: no device, or it failed.\n\nExample:\n  xrds doctor");
  addDevice(*verb, options->device);
  verb->add_option("--runs", options->runs, "How often each runs")->check(CLI::Range(2, 1000))->capture_default_str();
  verb->add_option("--json", options->json, "File to write with every number")->type_name("JSON");
  addQuiet(*verb, options->quiet);
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
