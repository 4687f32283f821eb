#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/bench/quality_scenes.h"
#include "image/metrics/metrics.h"
#include "xrds/xrds.hpp"

namespace xrds {

/// A model, the name under which it is reported, and what the user called it.
struct NamedModel {
  std::string name, asked;
  Model model;
};

/// The middle, the least and the most of some samples.
struct Spread {
  double median = 0, least = 0, most = 0;
};

/// The dispatches of one program in a frame, summed.
struct KernelSum {
  std::string program;
  int dispatches = 0;
  uint64_t multiplyAdds = 0, bytes = 0;
  double seconds = 0;
};

/// Which network is measured where: `side` x `side` pixels of output on the device that --device calls so.
struct NetworkCase {
  std::string device, precision, family;  // no family: the one that suits the device
  const NamedModel* model = nullptr;
  uint32_t side = 0;
  bool fp16() const { return precision == kFp16; }
};

/// What a case takes, or why it does not run.
struct NetworkMeasurement {
  Model::Cost cost;
  std::string refusal;                          // what the device said; all below is then missing
  std::string kernelFamily;                     // that ran
  double open = 0, preparation = 0, first = 0;  // seconds of the Device, of the Upscaler, and of the first frame
  Spread wall;                                  // seconds of the later frames
  std::optional<Spread> device;                 // seconds of their dispatches; nothing without timestamps
  uint64_t deviceBytes = 0;
  std::optional<uint64_t> peakProcessBytes;
  std::vector<KernelSum> kernels;  // of the last frame
};

/// Opens the device, upscales one frame of random pixels `runs` + 1 times, and closes the device: what one case leaves
/// behind must not help the next. Throws Failure when interrupted, Error if the device cannot be opened.
/// A device without the kernel family refuses.
NetworkMeasurement measureNetwork(const NetworkCase& networkCase, int runs);

/// How far a model's result on a device is from its reference in double precision, on random pixels: 16 x 16 of colour.
struct EngineError {
  double relativeRms = 0;       // of the output: RMS of the difference over RMS of the reference
  double worstRelativeRms = 0;  // of all operators
  std::string worstOperator, kernelFamily;
  bool finite = true, withinBound = true;
  /// fp16 storage against fp32 on the same device and frame: RMS and largest difference, over the RMS of fp32.
  std::optional<double> relativeRmsToFp32{}, relativeMaxToFp32{};
};

/// Slow: a second for each 0.3 G multiply-adds. Throws Error if the device fails.
EngineError engineError(const NetworkCase& networkCase);

/// The mean metrics of a model on the scenes of a folder, or why there are none.
struct ImageError {
  Metrics mean;
  size_t scenes = 0;
  std::string missing{};
};

ImageError imageError(const NetworkCase& networkCase, const std::string& folder, const QualitySetting& setting);

}  // namespace xrds
