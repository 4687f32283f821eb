#pragma once

#include "engine/device.h"
#include "tuning/form.h"

namespace xrds {

/// The size class of a frame: the rounded logarithm of its low-resolution pixels to base 2.
uint32_t sizeClassOf(FrameShape frame);

/// Under which TuningRecord::frames has what came out for a model on a device that runs the family.
std::string frameKey(const NetworkConfig& config, uint32_t size, Precision precision, KernelFamily family);

/// The file in which a device's tuning is kept, and what it holds that is still true.
TuningFile tuningFileOf(const Gpu& gpu);
TuningRecord knownRecord(const Gpu& gpu);

/// The program as it is now.
ProgramStamp stampOf(const Gpu& gpu, const std::string& program);

/// What came out for a model in frames of a size.
struct TuningResult {
  KernelTable table{};
  TunedFrame frame{};
  std::vector<TunedShape> shapes{};                                     // of the chosen form, the slowest first
  std::map<std::string, std::pair<uint64_t, std::string>> struckOff{};  // as in TuningRecord
  size_t measured = 0;                                                  // kernels that were not known before
  bool isKept = true;  // else the record cannot be written, and this process alone knows it
};

/// What tuning found for the model in frames of that size, or else of a quarter to four times as many pixels; nothing
/// if it was not tuned, or programs have changed since. An empty table: the fixed choice is the best. Takes
/// milliseconds.
std::optional<KernelTable> tunedKernels(const Gpu& gpu, const NetworkModel& model, FrameShape frame,
                                        Precision precision);

/// The same with all that is known. Writes the model's graph for it.
std::optional<TuningResult> knownTuning(const Gpu& gpu, const NetworkModel& model, FrameShape frame,
                                        Precision precision);

}  // namespace xrds
