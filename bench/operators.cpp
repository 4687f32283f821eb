// Times every distinct operator of the networks, each compared with its double-precision reference before. A kernel
// that gives something else is an error, not a time.
#include <benchmark/benchmark.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include "bench/operator_case.h"
#include "bench/peaks.h"
#include "bench/timing.h"
#include "checks/matrix_proof.h"
#include "network/fields.h"
#include "network/published.h"
#include "shaders/programs.h"
#include "xrds/error.h"

namespace xrds::bench {
namespace {

struct OperatorsOptions {
  std::vector<std::string> networks{"paper", "compact", "bicubic"}, precisions{kFp32, kFp16};
  std::string device, family;
  uint32_t side = 1024;
};

/// What all benchmarks share; it outlives them.
struct Bench {
  Gpu gpu;
  DevicePeaks peaks;
  std::map<std::string, OperatorError> errors;  // by case, as a benchmark runs several times
  int failures = 0;
};

// Of xrds.
const std::map<std::string, NetworkConfig> kNetworks{
    {"paper", {}},
    {"bicubic", {.auxInputs = {}, .groups = 0, .base = BaseImage::bicubic}},
    {"compact",
     {.channels = 32,
      .auxChannels = 16,
      .blocks = 1,
      .kernels = 5,
      .auxSkip = true,
      .auxKernels = 5,
      .outputSide = 1}}};

NetworkModel modelOf(const std::string& network) {
  const auto own = kNetworks.find(network);
  return own != kNetworks.end() ? NetworkModel::random(own->second, 1) : readOrPublished(network);
}

std::string nameOf(const std::string& network) { return std::filesystem::path(network).stem().string(); }

void count(benchmark::State& state, const Bench& bench, const OperatorCase& operatorCase, double seconds) {
  const OperatorWork work = workOf(operatorCase, bench.gpu.traits());
  const double perRun = seconds / static_cast<double>(state.iterations());
  const double flops = 2 * static_cast<double>(work.multiplyAdds), bytes = static_cast<double>(work.byteSize);
  const double products = 2 * static_cast<double>(work.products);
  const double least = std::max(products / bench.peaks.flops, bytes / bench.peaks.bytesPerSecond);
  const OperatorError& error = bench.errors.at(operatorCase.name);
  if (flops > 0) state.counters["GFLOP/s"] = 1e-9 * flops / perRun;
  state.counters["GB/s"] = 1e-9 * bytes / perRun;
  state.counters["ofRoofline"] = least / perRun;
  state.counters["perFrame"] = operatorCase.nodesPerFrame;
  state.counters["rmsError"] = error.rms;
  state.counters["maxError"] = error.max;
}

void runCase(benchmark::State& state, Bench& bench, const OperatorCase& operatorCase) {
  const auto known = bench.errors.find(operatorCase.name);
  const OperatorError error =
      known != bench.errors.end() ? known->second : compareWithReference(bench.gpu, operatorCase);
  bench.errors[operatorCase.name] = error;
  if (!error.withinTolerance) {
    ++bench.failures;
    char text[128];
    std::snprintf(text, sizeof text, "differs from the reference: relative RMS %.3g, largest %.3g", error.rms,
                  error.max);
    return state.SkipWithError(text);
  }
  const PlacedOperator placed(bench.gpu, operatorCase.graph);
  TimedRecording recording(bench.gpu, placed.dispatches());
  recording.run();  // compiles
  double sum = 0;
  for ([[maybe_unused]] auto _ : state) {
    const double seconds = recording.run();
    state.SetIterationTime(seconds);
    sum += seconds;
  }
  count(state, bench, operatorCase, sum);
  state.SetLabel(operatorCase.shapes + ", " + placed.dispatches().front().dispatch.program);
}

void runOrSkip(benchmark::State& state, Bench& bench, const OperatorCase& operatorCase) {
  try {
    runCase(state, bench, operatorCase);
  } catch (const std::exception& error) {
    ++bench.failures;
    state.SkipWithError(error.what());
  }
}

void describe(const Bench& bench, const OperatorsOptions& options) {
  const auto number = [](double value) { return std::to_string(std::lround(value)); };
  benchmark::AddCustomContext("device", bench.gpu.description().name);
  benchmark::AddCustomContext("driver", bench.gpu.description().driver);
  benchmark::AddCustomContext("outputSide", std::to_string(options.side));
  benchmark::AddCustomContext("peakFlops", number(bench.peaks.flops));
  benchmark::AddCustomContext("peakBytesPerSecond", number(bench.peaks.bytesPerSecond));
}

int run(const OperatorsOptions& options) {
  Bench bench{Gpu({.select = options.device, .kernelFamily = options.family, .programs = [](std::string_view name) {
                     const auto words = embeddedProgram(name);
                     return words.empty() ? peakProgram(name) : words;
                   }})};
  if (!proveMatrixKernels(bench.gpu)) std::fprintf(stderr, "The matrix kernels are wrong here: tile kernels run.\n");
  bench.peaks = measurePeaks(bench.gpu);
  describe(bench, options);
  std::vector<NetworkModel> models;
  models.reserve(options.networks.size());
  for (const std::string& network : options.networks) {
    models.push_back(modelOf(network));
    for (const std::string& precision : options.precisions)
      for (auto& operatorCase :
           distinctOperators(nameOf(network), models.back(), options.side,
                             precision == kFp16 ? Precision::fp16 : Precision::fp32, bench.gpu.traits()))
        benchmark::RegisterBenchmark(
            operatorCase.name.c_str(),
            [&bench, operatorCase](benchmark::State& state) { runOrSkip(state, bench, operatorCase); })
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::ClearRegisteredBenchmarks();
  return bench.failures == 0 ? 0 : 1;
}

std::string validNetwork(const std::string& text) {
  std::vector<std::string> names = publishedNames();
  for (const auto& [name, config] : kNetworks) names.push_back(name);
  if (text.ends_with(".safetensors") || std::find(names.begin(), names.end(), text) != names.end()) return "";
  return "expected a .safetensors file or one of " + joinedList(names) + ", found '" + text + "'";
}

}  // namespace
}  // namespace xrds::bench

int main(int argc, char** argv) {
  xrds::bench::OperatorsOptions options;
  CLI::App app(
      "Times every distinct operator of some networks against the device's measured peaks, after a comparison with "
      "its\n"
      "double-precision reference. Options of Google Benchmark are taken too: --benchmark_filter=linear,\n"
      "--benchmark_out=operators.json, ...",
      "xrds_bench_operators");
  app.add_option(
         "--network", options.networks,
         "Model files, or names of networks that get random weights: paper, compact, bicubic, edsr, rcan, swinir, ...")
      ->check(CLI::Validator(xrds::bench::validNetwork, "NETWORK"))
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--precision", options.precisions, "Storage of activations and weights")
      ->check(CLI::IsMember({xrds::kFp32, xrds::kFp16}))
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--size", options.side, "Side of the output in pixels")
      ->check(CLI::Range(8, 16384))
      ->capture_default_str();
  app.add_option("--device", options.device, "As xrds --device");
  app.add_option("--family", options.family,
                 "Kernels: plain, lane, tile, matrix or fused (default: what suits the device)");
  if (std::none_of(argv + 1, argv + argc, [](const std::string& word) { return word == "--help" || word == "-h"; }))
    benchmark::Initialize(&argc, argv);
  CLI11_PARSE(app, argc, argv);
  try {
    return xrds::bench::run(options);
  } catch (const xrds::Error& error) {
    std::fprintf(stderr, "xrds_bench_operators: %s\n", error.what());
    return 1;
  }
}
