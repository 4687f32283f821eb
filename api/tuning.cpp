#include "api/tuning.h"

#include <algorithm>
#include <charconv>
#include <ctime>

#include "api/arguments.h"
#include "api/model.h"
#include "engine/kernel_family.h"
#include "tuning/tuner.h"
#include "xrds/error.h"

namespace xrds {
namespace {

Precision precisionOf(bool fp16) { return fp16 ? Precision::fp16 : Precision::fp32; }

std::string textOf(const Winner& winner) {
  const auto [outputs, rows, subgroup] = winner.kernel.shape;
  std::string text = winner.program.name;
  if (outputs > 0) text += ", " + std::to_string(outputs) + " outputs";
  if (rows > 0) text += ", " + std::to_string(rows) + (rows > 1 ? " rows" : " row");
  if (subgroup > 0) text += ", subgroups of " + std::to_string(subgroup);
  return text;
}

// ", 1.12 times as fast".
std::string timesText(const Winner& winner, const TuningRecord& record) {
  char text[40];
  std::snprintf(text, sizeof text, ", %.2f times as fast", winner.fixedMicroseconds / winner.microseconds);
  if (winner.fixedMicroseconds > 0) return text;
  return record.isStruckOff(winner.fixedProgram) ? ", which is struck off" : ", which is wrong";
}

// Whether the fixed choice is wrong or struck off for an operator in frames of this size class.
bool isFixedOut(const TuningRecord& record, uint32_t size) {
  return std::any_of(record.winners.begin(), record.winners.end(), [&](const auto& each) {
    return each.first.size == size && !each.second.isFixed && each.second.fixedMicroseconds == 0;
  });
}

// What a frame gained, for people.
std::string gainText(const std::string& key, const TunedFrame& frame, const TuningRecord& record) {
  if (!frame.taken) return "the fixed choice, as whole frames gained nothing";
  if (frame.seconds > 0) {
    char text[64];
    std::snprintf(text, sizeof text, "%.2f times as fast as the fixed choice", frame.fixedSeconds / frame.seconds);
    return text;
  }
  uint32_t size = 0;  // a frame's key begins with it
  std::from_chars(key.data(), key.data() + key.size(), size);
  return isFixedOut(record, size) ? "other kernels, as the fixed choice is wrong or struck off for some operators"
                                  : "no kernel is faster than the fixed choice";
}

Tuning::Shape shapeOf(const TunedShape& tuned) {
  return {.name = tuned.shape.substr(0, tuned.shape.find(" (")),
          .nodes = tuned.nodes,
          .kernel = textOf(tuned.winner),
          .fixed = tuned.winner.fixedProgram.name,
          .seconds = tuned.seconds,
          .fixedSeconds = tuned.fixedSeconds,
          .tried = tuned.tried,
          .wrong = tuned.wrong};
}

Tuning::Report reportOf(const TuningResult& result, const DeviceTraits& traits) {
  Tuning::Report report{.taken = result.frame.taken,
                        .normsInLinear = result.frame.normsInLinear.value_or(traits.family == KernelFamily::lane),
                        .layersFused = result.frame.layersFused.value_or(traits.family == KernelFamily::fused),
                        .seconds = result.frame.seconds,
                        .fixedSeconds = result.frame.fixedSeconds,
                        .tuningSeconds = result.frame.tuningSeconds,
                        .date = result.frame.date,
                        .measured = result.measured};
  for (const TunedShape& shape : result.shapes) report.shapes.push_back(shapeOf(shape));
  for (const auto& [program, struck] : result.struckOff) report.struckOff.push_back({program, struck.second});
  return report;
}

std::string unkeptText(const Gpu& gpu) {
  const auto file = tuningFileOf(gpu).path();
  return "what tuning found is not kept: " +
         (file.empty() ? "there is no cache folder" : "'" + file.string() + "' cannot be written") +
         "; make room there, or let XDG_CACHE_HOME name another folder";
}

// The choice is the device's own only where nobody made another.
void requireOwnFamily(const Gpu& gpu) {
  if (gpu.hasAskedFamily())
    throw Error("The kernels of the " + std::string(nameOf(gpu.traits().family)) +
                " family were asked for, so there is nothing to tune: unset XRDS_KERNEL_FAMILY, or ask for no family.");
}

std::string dateText(int64_t seconds) {
  const std::time_t time = seconds;
  char text[32] = "";
  if (const std::tm* parts = std::gmtime(&time)) std::strftime(text, sizeof text, "%Y-%m-%d", parts);
  return text;
}

}  // namespace

Tuning::Report tuneFor(Gpu& gpu, const NetworkModel& network, uint32_t width, uint32_t height,
                       const Tuning::Options& options) {
  checkShape(network.config(), {height, width});
  requireOwnFamily(gpu);
  TuningOptions inner{.precision = precisionOf(options.fp16), .anew = options.anew};
  const uint32_t scale = network.config().scale;
  inner.label = (options.label.empty() ? hashText(network) : options.label) + ", " + precisionName(options.fp16) +
                ", " + sizeText(scale * width, scale * height);
  if (options.progress)
    inner.progress = [&](const TuningStep& step) { return options.progress(step.share, step.text); };
  const TuningResult result = xrds::tune(gpu, network, {height, width}, inner);
  Tuning::Report report = reportOf(result, gpu.traits());
  if (!result.isKept) report.unkept = unkeptText(gpu);
  return report;
}

std::optional<Tuning::Report> tuningFor(const Gpu& gpu, const NetworkModel& network, uint32_t width, uint32_t height,
                                        bool fp16) {
  checkShape(network.config(), {height, width});
  const auto result = knownTuning(gpu, network, {height, width}, precisionOf(fp16));
  if (!result) return std::nullopt;
  return reportOf(*result, gpu.traits());
}

std::vector<std::string> tuningSummary(const Gpu& gpu) {
  const TuningRecord record = knownRecord(gpu);
  const std::string family = nameOf(gpu.traits().family);
  std::vector<std::string> lines;
  if (gpu.hasAskedFamily())
    lines.push_back("the " + family + " family, which was asked for: nothing that was tuned is used");
  else
    lines.push_back("the " + family +
                    " family, the fixed choice for a device of this kind, wherever nothing else was tuned");
  if (record.frames.empty()) lines.push_back("not tuned for any model: xrds tune does it");
  for (const auto& [key, frame] : record.frames)
    lines.push_back("tuned on " + dateText(frame.date) + " for " + frame.label + ": " + gainText(key, frame, record));
  for (const auto& [key, winner] : record.winners)
    if (!winner.isFixed)
      lines.push_back(key.shape.substr(0, key.shape.find(" (")) + ": " + textOf(winner) + " in place of " +
                      winner.fixedProgram.name + timesText(winner, record));
  for (const auto& [program, struck] : record.struckOff)
    lines.push_back(program + " is struck off for this driver: " + struck.second);
  return lines;
}

}  // namespace xrds
