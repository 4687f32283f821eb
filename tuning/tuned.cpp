#include "tuning/tuned.h"

#include <cmath>
#include <map>

#include "engine/bytes.h"

namespace xrds {
namespace {

/// What a record holds for a frame: under which key, and of which size class.
struct Place {
  std::string key;
  uint32_t size = 0;
};

std::optional<Place> placeOf(const TuningRecord& record, const NetworkConfig& config, FrameShape frame,
                             Precision precision, KernelFamily family) {
  const uint32_t size = sizeClassOf(frame);
  for (const int distance : {0, 1, -1, 2, -2}) {
    const uint32_t near = size + static_cast<uint32_t>(distance);
    std::string key = frameKey(config, near, precision, family);
    if (record.frames.contains(key)) return Place{std::move(key), near};
  }
  return std::nullopt;
}

KernelTable tableOf(const TuningRecord& record, const Place& place) {
  const TunedFrame& frame = record.frames.at(place.key);
  KernelTable table;
  if (!frame.taken) return table;
  table.normsInLinear = frame.normsInLinear;
  table.layersFused = frame.layersFused;
  for (const auto& [key, winner] : record.winners)
    if (key.size == place.size && !winner.isFixed) table.kernels[key.shape] = winner.kernel;
  return table;
}

}  // namespace

uint32_t sizeClassOf(FrameShape frame) {
  return static_cast<uint32_t>(std::lround(std::log2(static_cast<double>(frame.width) * frame.height)));
}

std::string frameKey(const NetworkConfig& config, uint32_t size, Precision precision, KernelFamily family) {
  std::string text;
  for (const auto& [name, value] : describe(config)) text += name + "=" + value + ";";
  const uint64_t hash = hashOf(std::as_bytes(std::span(text)));
  return std::to_string(size) + (precision == Precision::fp16 ? " fp16 " : " fp32 ") + nameOf(family) + " " +
         std::to_string(hash);
}

TuningFile tuningFileOf(const Gpu& gpu) { return {gpu.cacheFolder(), gpu.driverKey()}; }

ProgramStamp stampOf(const Gpu& gpu, const std::string& program) {
  const auto words = gpu.program(program);
  return {program, words.empty() ? 0 : hashOf(std::as_bytes(words))};
}

TuningRecord knownRecord(const Gpu& gpu) {
  TuningRecord record = tuningFileOf(gpu).read();
  std::map<std::string, uint64_t> known;  // each program stands in many findings
  record.dropStale([&](const std::string& program) {
    const auto [found, isNew] = known.try_emplace(program, 0);
    if (isNew) found->second = stampOf(gpu, program).hash;
    return found->second;
  });
  return record;
}

std::optional<KernelTable> tunedKernels(const Gpu& gpu, const NetworkModel& model, FrameShape frame,
                                        Precision precision) {
  const TuningRecord record = knownRecord(gpu);
  const auto place = placeOf(record, model.config(), frame, precision, gpu.traits().family);
  return place ? std::optional(tableOf(record, *place)) : std::nullopt;
}

std::optional<TuningResult> knownTuning(const Gpu& gpu, const NetworkModel& model, FrameShape frame,
                                        Precision precision) {
  const TuningRecord record = knownRecord(gpu);
  const auto place = placeOf(record, model.config(), frame, precision, gpu.traits().family);
  if (!place) return std::nullopt;
  TuningResult result{tableOf(record, *place), record.frames.at(place->key)};
  const Form form = formOf(model, frame, precision, gpu.traits(),
                           {.normsInLinear = result.frame.normsInLinear, .layersFused = result.frame.layersFused});
  result.shapes = tunedShapes(form, record, place->size);
  result.struckOff = record.struckOff;
  return result;
}

}  // namespace xrds
