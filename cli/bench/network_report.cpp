#include "cli/bench/network_report.h"

#include <nlohmann/json.hpp>
#include <thread>

#include "cli/device_json.h"
#include "cli/json_text.h"
#include "cli/table.h"

namespace xrds {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::pair<const char*, const char*> kDefinitions[] = {
    {"family", "the kernels that were asked for; empty: those that suit the device, which kernelFamily names"},
    {"networkMultiplyAdds", "as papers count them: of linear maps and convolutions as the network is written"},
    {"multiplyAdds", "those that run; attentionMultiplyAdds are beside them, of its token pairs"},
    {"openSeconds", "opening the device"},
    {"preparationSeconds",
     "planning, packing and uploading the weights, recording, compiling where the driver does it"},
    {"firstSeconds", "the first frame, from the upload of the images to the download of the result; may compile"},
    {"wallSeconds", "the later frames: median, least and most"},
    {"deviceSeconds", "the same frames, the sum of their dispatches' time stamps; absent where the device has none"},
    {"memory.plannedBytes", "the arena, in which values share bytes once they are dead"},
    {"memory.lowerBoundBytes", "the largest set of values alive at once: no plan is smaller"},
    {"memory.unaliasedBytes", "the sum of all values"},
    {"memory.deviceBytes", "what was allocated on the device: arena and packed weights"},
    {"memory.peakProcessBytes",
     "largest resident memory of the process, the images on the host included, and on a CPU "
     "device the arena too; what earlier cases left in the allocator counts; Linux only"},
    {"kernels", "of the last frame, by program; bytes are those that its dispatches bind"},
    {"engineError.relativeRms",
     "RMS of the output's difference to the double-precision reference over the RMS of the reference, on random pixels "
     "of 16 x 16 of colour; in fp16 the reference has the weights and values in double precision too"},
    {"engineError.worstRelativeRms", "the same of the operator with the largest error"},
    {"engineError.relativeRmsToFp32", "fp16 against fp32 on the same device and pixels, over the RMS of fp32"},
    {"engineError.relativeMaxToFp32", "the largest difference of these, over the RMS of fp32"},
    {"imageError", "mean over the scenes against their references"},
};

std::string milliseconds(double seconds) { return text("%.2f", 1e3 * seconds); }
std::string megabytes(uint64_t bytes) { return text("%.1f", 1e-6 * static_cast<double>(bytes)); }

// The kernel family that ran, or that was to run.
std::string familyOf(const std::string& ran, const NetworkCase& networkCase) {
  if (!ran.empty()) return ran;
  return networkCase.family.empty() ? "-" : networkCase.family;
}

Row timeRow(const NetworkRow& row) {
  const NetworkMeasurement& measured = row.measurement;
  Row cells{row.networkCase.model->name, row.networkCase.precision, familyOf(measured.kernelFamily, row.networkCase),
            std::to_string(row.networkCase.side)};
  const Row memory{megabytes(measured.cost.plannedBytes), megabytes(measured.cost.lowerBoundBytes)};
  const Row times =
      measured.refusal.empty()
          ? Row{text("%.2f", measured.preparation), text("%.2f", measured.first),
                milliseconds(measured.wall.median), milliseconds(measured.wall.least),
                milliseconds(measured.wall.most),   measured.device ? milliseconds(measured.device->median) : "-"}
          : Row{"refused", "-", "-", "-", "-", "-"};
  cells.insert(cells.end(), times.begin(), times.end());
  cells.insert(cells.end(), memory.begin(), memory.end());
  cells.push_back(measured.peakProcessBytes ? megabytes(*measured.peakProcessBytes) : "-");
  return cells;
}

Row accuracyRow(const AccuracyRow& row) {
  const auto& engine = row.engine;
  Row cells{row.networkCase.model->name, row.networkCase.precision,
            familyOf(engine ? engine->kernelFamily : "", row.networkCase)};
  cells.push_back(engine ? text("%.2e", engine->relativeRms) + (engine->withinBound ? "" : " DIVERGES") : "-");
  cells.push_back(engine ? text("%.2e", engine->worstRelativeRms) + " " + engine->worstOperator : "-");
  cells.push_back(engine && engine->relativeMaxToFp32 ? text("%.2e", *engine->relativeMaxToFp32) : "-");
  const bool measured = row.image && row.image->missing.empty();
  cells.push_back(measured ? text("%.3f", row.image->mean.psnr) : "-");
  cells.push_back(measured ? text("%.4f", row.image->mean.relMse) : "-");
  return cells;
}

Json caseJson(const NetworkCase& networkCase) {
  return {{"device", networkCase.device},
          {"model", networkCase.model->name},
          {"scale", networkCase.model->model.scale()},
          {"precision", networkCase.precision},
          {"family", networkCase.family}};
}

Json jsonOf(const Spread& spread) {
  return {{"median", spread.median}, {"least", spread.least}, {"most", spread.most}};
}

Json jsonOf(const NetworkRow& row) {
  const NetworkMeasurement& measured = row.measurement;
  Json json = caseJson(row.networkCase);
  json["modelHash"] = row.networkCase.model->model.hash();
  json["width"] = json["height"] = row.networkCase.side;
  json["parameters"] = measured.cost.parameters;
  json["networkMultiplyAdds"] = measured.cost.networkMultiplyAdds;
  json["multiplyAdds"] = measured.cost.multiplyAdds;
  json["attentionMultiplyAdds"] = measured.cost.attentionMultiplyAdds;
  Json& memory = json["memory"] = {{"plannedBytes", measured.cost.plannedBytes},
                                   {"lowerBoundBytes", measured.cost.lowerBoundBytes},
                                   {"unaliasedBytes", measured.cost.unaliasedBytes},
                                   {"weightBytes", measured.cost.weightBytes}};
  if (measured.peakProcessBytes) memory["peakProcessBytes"] = *measured.peakProcessBytes;
  if (!measured.refusal.empty()) {
    json["refused"] = measured.refusal;
    return json;
  }
  json["kernelFamily"] = measured.kernelFamily;
  memory["deviceBytes"] = measured.deviceBytes;
  json["openSeconds"] = measured.open;
  json["preparationSeconds"] = measured.preparation;
  json["firstSeconds"] = measured.first;
  json["wallSeconds"] = jsonOf(measured.wall);
  if (measured.device) json["deviceSeconds"] = jsonOf(*measured.device);
  for (const KernelSum& kernel : measured.kernels)
    json["kernels"].push_back({{"program", kernel.program},
                               {"dispatches", kernel.dispatches},
                               {"seconds", kernel.seconds},
                               {"multiplyAdds", kernel.multiplyAdds},
                               {"bytes", kernel.bytes}});
  return json;
}

Json jsonOf(const EngineError& error) {
  Json json{{"relativeRms", error.relativeRms},
            {"worstRelativeRms", error.worstRelativeRms},
            {"worstOperator", error.worstOperator},
            {"kernelFamily", error.kernelFamily},
            {"finite", error.finite},
            {"withinBound", error.withinBound}};
  if (error.relativeRmsToFp32) json["relativeRmsToFp32"] = *error.relativeRmsToFp32;
  if (error.relativeMaxToFp32) json["relativeMaxToFp32"] = *error.relativeMaxToFp32;
  return json;
}

Json jsonOf(const AccuracyRow& row) {
  Json json = caseJson(row.networkCase);
  if (row.engine) json["engineError"] = jsonOf(*row.engine);
  if (row.image && row.image->missing.empty())
    json["imageError"] = {{"psnr", row.image->mean.psnr},
                          {"relMse", row.image->mean.relMse},
                          {"relMseTrimmed", row.image->mean.relMseTrimmed},
                          {"flip", row.image->mean.flip},
                          {"scenes", row.image->scenes}};
  else if (row.image)
    json["imageErrorMissing"] = row.image->missing;
  return json;
}

}  // namespace

std::string plainText(const NetworkReport& report) {
  std::string lines;
  for (const Device::Description& device : report.devices) {
    std::vector<Row> times{{"model", "precision", "kernels", "side", "prepare s", "first s", "median ms", "least",
                            "most", "device ms", "arena MB", "bound MB", "process MB"}};
    std::vector<Row> errors{
        {"model", "precision", "kernels", "engine error", "of operators, worst", "max to fp32", "PSNR dB", "RelMSE"}};
    std::string notes;
    for (const NetworkRow& row : report.networks) {
      if (row.networkCase.device != device.uuid) continue;
      times.push_back(timeRow(row));
      if (!row.measurement.refusal.empty())
        notes += "refused: " + row.networkCase.model->name + ", " + row.networkCase.precision + ", " +
                 (row.networkCase.family.empty() ? "" : row.networkCase.family + ", ") +
                 std::to_string(row.networkCase.side) + ": " + row.measurement.refusal + "\n";
    }
    for (const AccuracyRow& row : report.accuracies) {
      if (row.networkCase.device != device.uuid) continue;
      errors.push_back(accuracyRow(row));
      if (row.image && !row.image->missing.empty())
        notes += "no image error: " + row.networkCase.model->name + ": " + row.image->missing + "\n";
    }
    lines += device.name + " (" + device.driver + "), median of " + std::to_string(report.runs) + " frames\n\n" +
             aligned(times) + (errors.size() > 1 ? "\n" + aligned(errors) : "") + (notes.empty() ? "" : "\n" + notes);
  }
  return lines;
}

std::string jsonText(const NetworkReport& report) {
  Json json{{"version", XRDS_VERSION}, {"processors", std::thread::hardware_concurrency()}, {"runs", report.runs}};
  if (!report.scenes.empty()) json["scenes"] = report.scenes;
  for (const auto& [name, definition] : kDefinitions) json["definitions"][name] = definition;
  for (const std::string& definition : metricDefinitions()) json["metricDefinitions"].push_back(definition);
  for (const auto& device : report.devices) json["devices"].push_back(jsonOf(device));
  json["networks"] = json["accuracies"] = Json::array();
  for (const NetworkRow& row : report.networks) json["networks"].push_back(jsonOf(row));
  for (const AccuracyRow& row : report.accuracies) json["accuracies"].push_back(jsonOf(row));
  return textOf(json);
}

}  // namespace xrds
