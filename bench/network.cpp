// Times whole networks: random weights of any configuration, or a model file, for one frame size. Prints the first run
// (with compilation), the median of the steady ones with its parts, and time and rate of each kind of kernel.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <random>

#include "checks/matrix_proof.h"
#include "frames/session.h"
#include "network/published.h"
#include "shaders/programs.h"
#include "xrds/error.h"

namespace xrds {
namespace {

struct BenchOptions {
  NetworkConfig config;
  uint32_t bandRows = 0;
  std::string model, writeModel, device, family, precision = kFp32;
  uint32_t size = 1024;  // side of the output in pixels
  int runs = 5;
};

std::vector<float> randomImage(size_t pixels, std::minstd_rand& random) {
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<float> image(3 * pixels);
  for (float& value : image) value = uniform(random);
  return image;
}

double seconds(const std::function<void()>& action) {
  const auto start = std::chrono::steady_clock::now();
  action();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void printKernels(const std::vector<DispatchTime>& times) {
  struct Sum {
    double microseconds = 0;
    uint64_t multiplyAdds = 0;
    int runs = 0;
  };
  std::map<std::string, Sum> sums;
  for (const DispatchTime& time : times) {
    Sum& sum = sums[time.program];
    sum.microseconds += time.microseconds;
    sum.multiplyAdds += time.multiplyAdds;
    ++sum.runs;
  }
  std::printf("%-32s %6s %10s %9s\n", "kernel", "runs", "ms", "GFLOP/s");
  for (const auto& [program, sum] : sums)
    std::printf("%-32s %6d %10.1f %9.1f\n", program.c_str(), sum.runs, sum.microseconds / 1e3,
                2e-3 * static_cast<double>(sum.multiplyAdds) / sum.microseconds);
}

void run(const BenchOptions& options) {
  const NetworkModel model =
      options.model.empty() ? NetworkModel::random(options.config, 1) : readOrPublished(options.model);
  if (!options.writeModel.empty()) writeTensors(options.writeModel, model.file(), DataType::f16);
  Gpu gpu({.select = options.device, .kernelFamily = options.family, .programs = embeddedProgram});
  if (!proveMatrixKernels(gpu)) std::printf("the matrix kernels are wrong here: tile kernels run instead\n");
  const uint32_t side = options.size / model.config().scale;
  std::minstd_rand random(1);
  const std::vector<float> colour = randomImage(size_t{side} * side, random);
  std::vector<std::vector<float>> auxiliary(model.config().auxInputs.size());
  for (auto& image : auxiliary) image = randomImage(size_t{options.size} * options.size, random);
  std::vector<float> output(size_t{3} * side * side * model.config().scale * model.config().scale);
  FrameInput input{{colour.data(), side, side}};
  for (const auto& image : auxiliary) input.auxiliary.push_back({image.data(), options.size, options.size});

  const Precision precision = options.precision == kFp16 ? Precision::fp16 : Precision::fp32;
  std::unique_ptr<Session> session;
  const double preparation = seconds([&] {
    session = std::make_unique<Session>(
        gpu, model, FrameShape{side, side},
        SessionOptions{.precision = precision, .timestamps = true, .bandRows = options.bandRows});
  });
  const double first = seconds([&] { session->run(input, output); });
  std::vector<double> steady, uploads, replays, downloads;
  for (int i = 0; i < options.runs; ++i) {
    uploads.push_back(seconds([&] { session->upload(input); }));
    replays.push_back(seconds([&] { session->replay(); }));
    downloads.push_back(seconds([&] { session->download(output); }));
    steady.push_back(uploads.back() + replays.back() + downloads.back());
  }
  for (auto* times : {&steady, &uploads, &replays, &downloads}) std::sort(times->begin(), times->end());
  const auto median = [](const std::vector<double>& times) { return times[times.size() / 2]; };
  std::printf("device %s (%s)\noutput %u x %u, %s, arena %.1f MB, weights %.1f MB\n", gpu.description().name.c_str(),
              gpu.description().driver.c_str(), options.size, options.size, options.precision.c_str(),
              static_cast<double>(session->plan().byteSize) / 1e6,
              static_cast<double>(session->weightByteSize()) / 1e6);
  std::printf("preparation %.3f s, first run %.3f s, steady median %.6f s (least %.6f, most %.6f, %d runs)\n",
              preparation, first, median(steady), steady.front(), steady.back(), options.runs);
  std::printf("of which upload %.6f s, run %.6f s, download %.6f s\n", median(uploads), median(replays),
              median(downloads));
  printKernels(session->times());
}

}  // namespace
}  // namespace xrds

int main(int argc, char** argv) {
  xrds::BenchOptions options;
  CLI::App app("Times a whole network with random weights or a model file", "xrds_bench_network");
  CLI::Option* model = app.add_option(
      "--model", options.model,
      "Model file, or edsr, rcan, swinir, ... with random weights (default: random weights of the symbols below)");
  xrds::NetworkConfig& config = options.config;
  CLI::Option_group* symbols = app.add_option_group("Symbols of a network with random weights");
  symbols->excludes(model);
  symbols->add_option("--scale", config.scale, "s")->capture_default_str();
  symbols->add_option("--channels", config.channels, "C")->capture_default_str();
  symbols->add_option("--aux-channels", config.auxChannels, "Ca")->capture_default_str();
  symbols->add_option("--groups", config.groups, "N")->capture_default_str();
  symbols->add_option("--blocks", config.blocks, "B")->capture_default_str();
  symbols->add_option("--head-channels", config.headChannels, "d")->capture_default_str();
  symbols->add_option("--kernels", config.kernels, "0 or 5")->capture_default_str();
  symbols->add_option("--aux-kernels", config.auxKernels, "0, 3 or 5")->capture_default_str();
  symbols->add_option("--output-side", config.outputSide, "3 or 1")->capture_default_str();
  symbols->add_flag("--aux-skip", config.auxSkip, "Feed H_N to the output convolution");
  app.add_option("--size", options.size, "Side of the output in pixels")->capture_default_str();
  app.add_option("--precision", options.precision, "fp32 or fp16")
      ->check(CLI::IsMember({xrds::kFp32, xrds::kFp16}))
      ->capture_default_str();
  app.add_option("--runs", options.runs, "Steady runs")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--device", options.device, "As xrds --device");
  app.add_option("--band-rows", options.bandRows, "Low-resolution rows of a band; 0: chosen by size, 65536: none");
  app.add_option("--family", options.family,
                 "Kernels: plain, lane, tile, matrix or fused (default: what suits the device)");
  app.add_option("--write-model", options.writeModel, "Also write the model to this file, for xrds info");
  CLI11_PARSE(app, argc, argv);
  try {
    xrds::run(options);
  } catch (const xrds::Error& error) {
    std::fprintf(stderr, "xrds_bench_network: %s\n", error.what());
    return 1;
  }
}
