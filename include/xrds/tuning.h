#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "xrds/device.h"
#include "xrds/model.h"
#include "xrds/xrds_examine.h"

namespace xrds {

/// Finds out which kernels are the fastest on a device. Each kernel that may make an operator of a model is compared
/// with double precision, timed on the device, and the winners are kept in the device's cache folder, for its driver.
/// Upscalers take them from there: Upscaler::Options::tune. One thread and one process at a time.
struct Tuning {
  struct Options {
    bool fp16 = false;
    std::string label{};  // what summary() calls the model
    bool anew = false;    // forgets what is known of the device, struck-off kernels, too
    /// Called before each kernel with the share done in [0, 1] and what is tried next; returning false ends the tuning
    /// with Cancelled. What is known by then is kept.
    std::function<bool(double share, const std::string& text)> progress{};
  };

  /// One operator of the model, in all its places.
  struct Shape {
    std::string name;           // the operator and its channels: "linear 64 > 192"
    uint32_t nodes = 0;         // of the model
    std::string kernel, fixed;  // that won, and the fixed choice of the device's family: programs, with what else
                                // was chosen of their shape
    double seconds = 0, fixedSeconds = 0;  // of a frame, in this operator
    uint64_t tried = 0;                    // kernels
    std::vector<std::string> wrong;        // those that were, and how
  };
  struct StruckOff {
    std::string program, why;
  };

  /// What is known of a model in frames of a size.
  struct Report {
    bool taken = false;  // the winners are used; else whole frames gained nothing, and the fixed choice is
    bool normsInLinear = false, layersFused = false;  // how the graph is written
    double seconds = 0, fixedSeconds = 0;             // of a frame, measured in turns; 0: both are the same
    double tuningSeconds = 0;
    int64_t date = 0;                    // when it was tuned, in seconds since 1970
    std::vector<Shape> shapes{};         // the slowest first
    uint64_t measured = 0;               // kernels that were tried now; 0: all was known
    std::vector<StruckOff> struckOff{};  // of the device's driver
    std::string unkept{};                // why this process alone knows what run() found; empty: it is kept
  };

  /// Tunes for frames of width x height low-resolution pixels; what is known already is not tried again. Seconds on a
  /// GPU, minutes on a CPU. Throws DeviceLost if a kernel lost the device: it is struck off, so open the device anew
  /// and call this again. Throws Cancelled, and Error if the device runs kernels that were asked for, another process
  /// tunes it, or it fails.
  static Report run(Device& device, const Model& model, uint32_t width, uint32_t height, const Options& options);

  /// What an earlier run() found for such frames, or frames of a quarter to four times as many pixels; nothing if there
  /// was none, or driver or kernels have changed since. Milliseconds.
  static std::optional<Report> known(const Device& device, const Model& model, uint32_t width, uint32_t height,
                                     bool fp16);

  /// All that is known of the device: a line for each model and size, for people.
  static std::vector<std::string> summary(const Device& device);

  /// As the C API has it.
  static Report of(const XrdsTuningReport& found);
};

inline Tuning::Report Tuning::of(const XrdsTuningReport& found) {
  Report report{.taken = found.taken != 0,
                .normsInLinear = found.normsInLinear != 0,
                .layersFused = found.layersFused != 0,
                .seconds = found.seconds,
                .fixedSeconds = found.fixedSeconds,
                .tuningSeconds = found.tuningSeconds,
                .date = found.date,
                .measured = found.measured};
  for (uint32_t i = 0; i < found.shapeCount; ++i) {
    const XrdsTunedShape& shape = *found.shapes[i];
    report.shapes.push_back({.name = shape.name,
                             .nodes = shape.nodes,
                             .kernel = shape.kernel,
                             .fixed = shape.fixed,
                             .seconds = shape.seconds,
                             .fixedSeconds = shape.fixedSeconds,
                             .tried = shape.tried,
                             .wrong = {shape.wrong, shape.wrong + shape.wrongCount}});
  }
  for (uint32_t i = 0; i < found.struckOffCount; ++i)
    report.struckOff.push_back({found.struckOff[i]->program, found.struckOff[i]->why});
  if (found.unkept) report.unkept = found.unkept;
  return report;
}

inline Tuning::Report Tuning::run(Device& device, const Model& model, uint32_t width, uint32_t height,
                                  const Options& options) {
  auto asked = call::sized<XrdsTuningOptions>();
  asked.fp16 = options.fp16;
  asked.anew = options.anew;
  if (!options.label.empty()) asked.label = options.label.c_str();
  const auto tell = [&](double share, const char* text) { return options.progress(share, text); };
  call::Heard progress(tell);
  if (options.progress) asked.progress = decltype(progress)::template hear<double, const char*>;
  asked.user = progress.user();
  Report report;
  const auto take = [&](const XrdsTuningReport* found) { report = of(*found); };
  call::Heard heard(take);
  const XrdsResult result = xrdsTune(device.handle(), model.handle(), width, height, &asked,
                                     decltype(heard)::template listen<const XrdsTuningReport*>, heard.user());
  progress.finish(XRDS_OK);
  heard.finish(XRDS_OK);
  device.finish(result);
  return report;
}

inline std::optional<Tuning::Report> Tuning::known(const Device& device, const Model& model, uint32_t width,
                                                   uint32_t height, bool fp16) {
  std::optional<Report> report;
  const auto take = [&](const XrdsTuningReport* found) { report = of(*found); };
  call::Heard heard(take);
  heard.finish(xrdsGetTuning(device.handle(), model.handle(), width, height, fp16,
                             decltype(heard)::template listen<const XrdsTuningReport*>, heard.user()));
  return report;
}

inline std::vector<std::string> Tuning::summary(const Device& device) {
  std::vector<std::string> lines;
  const auto add = [&](const char* line) { lines.emplace_back(line); };
  call::Heard heard(add);
  heard.finish(xrdsDescribeTuning(device.handle(), decltype(heard)::template listen<const char*>, heard.user()));
  return lines;
}

}  // namespace xrds
