#include "cli/tune_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/device_json.h"
#include "cli/json_text.h"
#include "cli/table.h"
#include "xrds/precision.h"

namespace xrds {
namespace {

using Json = nlohmann::ordered_json;

bool isNew(const Tuning::Shape& shape) { return shape.kernel != shape.fixed; }

// "1.05", or "-" where the fixed choice is wrong or struck off.
std::string gainText(double fixedSeconds, double seconds) {
  return fixedSeconds > 0 && seconds > 0 ? text("%.2f", fixedSeconds / seconds) : "-";
}

std::string winnersTable(const std::vector<Tuning::Shape>& shapes) {
  std::vector<Row> rows{{"operator", "nodes", "tried", "winner", "in place of", "ms a frame", "times as fast"}};
  for (const Tuning::Shape& shape : shapes)
    if (isNew(shape))
      rows.push_back({shape.name, std::to_string(shape.nodes), std::to_string(shape.tried), shape.kernel, shape.fixed,
                      text("%.2f", 1e3 * shape.seconds), gainText(shape.fixedSeconds, shape.seconds)});
  return rows.size() > 1 ? aligned(rows) : "";
}

std::string conclusion(const Tuning::Report& report) {
  const auto count = std::count_if(report.shapes.begin(), report.shapes.end(), isNew);
  const std::string shapes = std::to_string(report.shapes.size()) + " operator shapes";
  if (report.seconds == 0 && count == 0) return "No kernel is faster than the fixed choice, in " + shapes + ".";
  const std::string times = text("%.3f s", report.seconds) + " with the winners and " +
                            text("%.3f s", report.fixedSeconds) + " with the fixed choice";
  const std::string have = "Of " + shapes + " " + std::to_string(count) + (count == 1 ? " has" : " have");
  if (report.seconds == 0)
    return have + " another kernel; the fixed choice, wrong or struck off for some, made no frame to compare with.";
  const std::string faster = have + " a faster kernel";
  if (!report.taken) return faster + ", but a frame takes " + times + ": the fixed choice is kept.";
  return faster + ": a frame takes " + times + ", " + gainText(report.fixedSeconds, report.seconds) + " times as fast.";
}

Json jsonOf(const Tuning::Shape& shape) {
  return {{"operator", shape.name},
          {"nodes", shape.nodes},
          {"tried", shape.tried},
          {"kernel", shape.kernel},
          {"fixedKernel", shape.fixed},
          {"seconds", shape.seconds},
          {"fixedSeconds", shape.fixedSeconds},
          {"wrong", shape.wrong}};
}

}  // namespace

std::string tuneText(const TunedModel& tuned) {
  const Tuning::Report& report = tuned.report;
  std::string lines = tuned.model + ", " + precisionName(tuned.fp16) + ", " + std::to_string(tuned.width) + " x " +
                      std::to_string(tuned.height) + "\n";
  lines += winnersTable(report.shapes);
  for (const Tuning::Shape& shape : report.shapes)
    for (const std::string& wrong : shape.wrong) lines += "wrong: " + shape.name + ": " + wrong + "\n";
  for (const auto& struck : report.struckOff) lines += "struck off: " + struck.program + ": " + struck.why + "\n";
  lines += conclusion(report) + "\n";
  lines += report.measured > 0 ? std::to_string(report.measured) + " kernels tried in " + text("%.1f s", tuned.seconds)
                               : "All was known: " + text("%.0f ms", 1e3 * tuned.seconds);
  return lines + ".\n\n";
}

std::string tuneJson(const Device::Description& device, const std::vector<TunedModel>& tuned) {
  Json json{{"version", XRDS_VERSION}, {"device", jsonOf(device)}};
  json["device"]["kernelFamily"] = device.kernelFamily;
  json["tuned"] = Json::array();
  for (const TunedModel& each : tuned) {
    const Tuning::Report& report = each.report;
    Json& one = json["tuned"].emplace_back(Json{{"model", each.model},
                                                {"precision", precisionName(each.fp16)},
                                                {"width", each.width},
                                                {"height", each.height},
                                                {"taken", report.taken},
                                                {"normsInLinear", report.normsInLinear},
                                                {"layersFused", report.layersFused},
                                                {"seconds", report.seconds},
                                                {"fixedSeconds", report.fixedSeconds},
                                                {"kernelsTried", report.measured},
                                                {"secondsNow", each.seconds},
                                                {"tuningSeconds", report.tuningSeconds},
                                                {"date", report.date},
                                                {"kept", report.unkept.empty()}});
    one["operators"] = Json::array();
    for (const Tuning::Shape& shape : report.shapes) one["operators"].push_back(jsonOf(shape));
    one["struckOff"] = Json::array();
    for (const auto& struck : report.struckOff)
      one["struckOff"].push_back({{"program", struck.program}, {"why", struck.why}});
  }
  return textOf(json);
}

}  // namespace xrds
