#include "cli/bench/network_measurement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <new>
#include <numeric>
#include <random>

#include "app/failing_with.h"
#include "app/timer.h"
#include "cli/bench/process_memory.h"
#include "cli/bench/quality_report.h"
#include "cli/bench/quantile.h"
#include "cli/progress.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

constexpr int kErrorSide = 16;  // of the colour on which the engine is compared with its reference

Device::Options optionsOf(const NetworkCase& networkCase) {
  return {.select = networkCase.device, .kernelFamily = networkCase.family};
}

Spread spreadOf(const std::vector<double>& samples) {
  const auto [least, most] = std::minmax_element(samples.begin(), samples.end());
  return {median(samples), *least, *most};
}

/// Random pixels in [0, 1): colour, and the model's auxiliary images.
struct RandomFrame {
  Image colour;
  std::vector<Image> auxiliary;

  RandomFrame(const Model& model, int side) : colour(side, side, 3) {
    const int full = side * static_cast<int>(model.scale());
    auxiliary.assign(model.auxiliaryInputs().size(), Image(full, full, 3));
    std::minstd_rand random(1);
    std::uniform_real_distribution<float> uniform(0, 1);
    const auto fill = [&](Image& image) {
      for (float& value : image.pixels) value = uniform(random);
    };
    fill(colour);
    for (Image& image : auxiliary) fill(image);
  }
};

std::vector<KernelSum> kernelSums(const std::vector<Upscaler::ProfileRow>& rows) {
  std::map<std::string, KernelSum> sums;
  for (const auto& row : rows) {
    KernelSum& sum = sums.try_emplace(row.program, KernelSum{row.program}).first->second;
    ++sum.dispatches;
    sum.multiplyAdds += row.multiplyAdds;
    sum.bytes += row.bytes;
    sum.seconds += 1e-6 * row.microseconds;
  }
  std::vector<KernelSum> sorted;
  sorted.reserve(sums.size());
  for (auto& [program, sum] : sums) sorted.push_back(std::move(sum));
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.seconds > b.seconds; });
  return sorted;
}

void runFrames(Upscaler& upscaler, const Model& model, int side, int runs, NetworkMeasurement& result) {
  const RandomFrame frame(model, side);
  const int full = side * static_cast<int>(model.scale());
  std::vector<float> output(size_t{3} * full * full);
  const auto views = viewsOf(frame.auxiliary);
  std::vector<double> wall, device;
  for (int run = 0; run <= runs; ++run) {
    const double taken =
        secondsOf([&] { upscaler.run(viewOf(frame.colour), views, output, [](double) { return !interrupted(); }); });
    stopIfInterrupted();
    if (run == 0) {
      result.first = taken;
      continue;
    }
    wall.push_back(taken);
    result.kernels = kernelSums(upscaler.profile());
    device.push_back(std::accumulate(result.kernels.begin(), result.kernels.end(), 0.0,
                                     [](double sum, const KernelSum& kernel) { return sum + kernel.seconds; }));
  }
  result.wall = spreadOf(wall);
  if (!result.kernels.empty()) result.device = spreadOf(device);
}

std::vector<float> upscaled(Device& device, const Model& model, const RandomFrame& frame, bool fp16) {
  const auto side = static_cast<uint32_t>(frame.colour.width);
  Upscaler upscaler(device, model, side, side, {.fp16 = fp16});
  std::vector<float> output(size_t{3} * side * side * model.scale() * model.scale());
  upscaler.run(viewOf(frame.colour), viewsOf(frame.auxiliary), output, [](double) { return !interrupted(); });
  stopIfInterrupted();
  return output;
}

void compareWithFp32(Device& device, const Model& model, const RandomFrame& frame, EngineError& error) {
  const std::vector<float> half = upscaled(device, model, frame, true), full = upscaled(device, model, frame, false);
  double squares = 0, power = 0, most = 0;
  for (size_t i = 0; i < full.size(); ++i) {
    const double difference = std::abs(double{half[i]} - full[i]);
    squares += difference * difference;
    power += double{full[i]} * full[i];
    most = std::max(most, difference);
  }
  error.relativeRmsToFp32 = std::sqrt(squares / power);
  error.relativeMaxToFp32 = most / std::sqrt(power / static_cast<double>(full.size()));
}

}  // namespace

NetworkMeasurement measureNetwork(const NetworkCase& networkCase, int runs) {
  const Model& model = networkCase.model->model;
  const uint32_t low = networkCase.side / model.scale();
  NetworkMeasurement result{.cost = model.cost(networkCase.side, networkCase.side, networkCase.fp16())};
  const bool ownPeak = resetPeakMemory();
  std::optional<Device> device;
  try {
    result.open = secondsOf([&] { device.emplace(optionsOf(networkCase)); });
    result.kernelFamily = device->description().kernelFamily;
    if (networkCase.family.empty()) result.kernelFamily = Upscaler::kernelFamily(result.kernelFamily, low, low);
    result.cost = model.cost(networkCase.side, networkCase.side, networkCase.fp16(), result.kernelFamily);
    std::optional<Upscaler> upscaler;
    result.preparation = secondsOf([&] {
      const TileOptions inOnePiece{.columns = 1, .rows = 1};
      upscaler.emplace(*device, model, low, low,
                       Upscaler::Options{.fp16 = networkCase.fp16(), .profile = true, .tiles = inOnePiece});
    });
    runFrames(*upscaler, model, static_cast<int>(low), runs, result);
    result.deviceBytes = upscaler->deviceBytes();
  } catch (const Error& error) {
    result.refusal = error.what();
  } catch (const std::bad_alloc&) {
    result.refusal = failureOf(std::current_exception()).message;
  }
  if (ownPeak && result.refusal.empty()) result.peakProcessBytes = peakMemory();
  return result;
}

EngineError engineError(const NetworkCase& networkCase) {
  const Model& model = networkCase.model->model;
  Device device(optionsOf(networkCase));
  const RandomFrame frame(model, kErrorSide);
  const auto rows =
      Upscaler::check(device, model, viewOf(frame.colour), viewsOf(frame.auxiliary), {.fp16 = networkCase.fp16()});
  EngineError error{.relativeRms = rows.back().relativeRms, .kernelFamily = device.description().kernelFamily};
  for (const auto& row : rows) {
    error.finite = error.finite && row.finite;
    error.withinBound = error.withinBound && row.withinBound;
    if (!error.worstOperator.empty() && row.relativeRms <= error.worstRelativeRms) continue;
    error.worstOperator = row.label;
    error.worstRelativeRms = row.relativeRms;
  }
  if (networkCase.fp16()) compareWithFp32(device, model, frame, error);
  return error;
}

ImageError imageError(const NetworkCase& networkCase, const std::string& folder, const QualitySetting& setting) {
  ImageError error;
  try {
    const SceneList list = findScenes(pathOf(folder), setting, {});
    Device device(optionsOf(networkCase));
    EngineMethod method = trainedMethod(networkCase.model->asked, setting.scale);
    MethodQuality quality{method.name()};
    for (const SceneFiles& files : list.scenes) {
      const Scene scene = loadScene(files, setting);
      FrameSeconds taken;
      const Image image = method.run(device, scene.frame, networkCase.fp16(), false, taken);
      quality.scenes.push_back({measure(image, scene.reference)});
    }
    error.mean = quality.mean();
    error.scenes = quality.scenes.size();
  } catch (const Error& failed) {
    error.missing = failed.what();
  }
  return error;
}

}  // namespace xrds
