#include "cli/bench/stress_report.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "cli/json_text.h"
#include "cli/table.h"

namespace xrds {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::pair<const char*, const char*> kDefinitions[] = {
    {"cases", "frames of 7 x 9 pixels, or wide enough for two tiles, each another image, exposure or set of weights"},
    {"casesInParts", "of these, those in exact or bounded tiles or with quiet windows skipped"},
    {"nonFiniteOutputs", "of these, those with a NaN or infinity in the result"},
    {"repairedPixels", "input pixels that were not finite, filled from their finite neighbours"},
    {"lostPixels", "output pixels whose network share was not finite and was left out"},
    {"worstError",
     "RMS of the difference to double precision over the RMS of that, in the transformed domain, the largest of the "
     "natural images with automatic exposure"},
    {"bounded",
     "false: with these weights the network amplifies rounding so much that no bound on its error is claimed"},
    {"worstScaling",
     "as worstError, between the result of a natural image and that of 1e-12 or 1e6 times its colour, over the factor"},
    {"litFromBlack", "pixels above 0 of frames whose colour is black, of models with a base image"},
    {"worstSkip", "the largest change of a window that was skipped, root mean square of log(1 + exposure radiance)"},
    {"firstDegraded", "the first operator whose own error, on the inputs that the device gave it, exceeds its budget"},
    {"promoted", "what the engine stores in fp32 although fp16 was asked for"},
};

std::string count(uint64_t number) { return std::to_string(number); }

/// Rows of the report taken together.
struct Sum {
  uint64_t cases = 0, nonFinite = 0, lost = 0, repaired = 0;
  double worstError = 0;
  std::string worst;
  size_t promoted = 0;

  void add(const StressRow& row, const std::string& name) {
    cases += row.cases;
    nonFinite += row.nonFiniteOutputs;
    lost += row.lostPixels;
    repaired += row.repairedPixels;
    promoted += row.promoted.size();
    if (row.worstError <= worstError) return;
    worstError = row.worstError;
    worst = name + ": " + row.worstInput;
  }
};

/// Takes rows of one key together, in the order in which keys appear.
class Sums {
 public:
  Sum& of(const std::vector<std::string>& key) {
    const auto known = std::find_if(sums_.begin(), sums_.end(), [&](const auto& sum) { return sum.first == key; });
    return known != sums_.end() ? known->second : sums_.emplace_back(key, Sum{}).second;
  }
  const auto& all() const { return sums_; }

 private:
  std::vector<std::pair<std::vector<std::string>, Sum>> sums_;
};

// One line for each change of weights, precision and family, over all models.
std::vector<Row> weightTable(const StressReport& report) {
  Sums sums;
  for (const StressRow& row : report.rows)
    sums.of({row.weights + (row.bounded ? "" : " *"), row.precision, row.family}).add(row, row.model);
  std::vector<Row> rows{{"weights", "precision", "kernels", "cases", "not finite", "pixels lost", "in fp32 instead",
                         "worst error", "of"}};
  for (const auto& [key, sum] : sums.all())
    rows.push_back({key[0], key[1], key[2], count(sum.cases), count(sum.nonFinite), count(sum.lost),
                    count(sum.promoted), text("%.1e", sum.worstError), sum.worst});
  return rows;
}

// One line for each model with the weights that it has.
std::vector<Row> modelTable(const StressReport& report) {
  Sums sums;
  for (const StressRow& row : report.rows)
    if (row.weights == report.rows.front().weights) sums.of({row.model}).add(row, row.model);
  std::vector<Row> rows{{"model", "cases", "pixels repaired", "fp32", "fp16", "first degraded operator"}};
  for (const auto& [key, sum] : sums.all()) {
    double fp32 = 0, fp16 = 0;
    std::string degraded;
    for (const StressRow& row : report.rows) {
      if (row.model != key[0] || row.weights != report.rows.front().weights) continue;
      double& error = row.precision == kFp32 ? fp32 : fp16;
      error = std::max(error, row.worstError);
      if (degraded.empty()) degraded = row.firstDegraded;
    }
    rows.push_back({key[0], count(sum.cases), count(sum.repaired), text("%.1e", fp32), text("%.1e", fp16),
                    degraded.empty() ? "none" : degraded});
  }
  return rows;
}

std::vector<Row> operatorTable(const StressReport& report) {
  std::vector<StressOperator> operators = report.operators;
  std::sort(operators.begin(), operators.end(), [](const auto& a, const auto& b) {
    return std::tie(a.precision, a.name, a.family) < std::tie(b.precision, b.name, b.family);
  });
  std::vector<Row> rows{{"operator", "precision", "kernels", "worst error", "budget", "at"}};
  for (const StressOperator& op : operators)
    rows.push_back({op.name, op.precision, op.family, text("%.1e", op.worstError), text("%.1e", op.budget), op.where});
  return rows;
}

std::string report(const StressReport& report, std::string (*table)(const std::vector<Row>&)) {
  const auto exceptions = report.exceptions();
  std::string lines = count(report.cases()) + " cases, seed " + count(report.seed) + "\n\n" +
                      table(weightTable(report)) + "\n* the error with these weights is shown, but not bounded\n\n" +
                      table(modelTable(report)) + "\n" + table(operatorTable(report)) + "\n" +
                      (exceptions.empty() ? "No exceptions: every bar is met.\n" : "Exceptions:\n");
  for (const std::string& exception : exceptions) lines += "- " + exception + "\n";
  return lines;
}

Json jsonOf(const StressRow& row) {
  return {{"model", row.model},
          {"weights", row.weights},
          {"precision", row.precision},
          {"family", row.family},
          {"bounded", row.bounded},
          {"cases", row.cases},
          {"casesInParts", row.casesInParts},
          {"nonFiniteOutputs", row.nonFiniteOutputs},
          {"repairedPixels", row.repairedPixels},
          {"lostPixels", row.lostPixels},
          {"naturalCases", row.naturalCases},
          {"worstError", row.worstError},
          {"worstInput", row.worstInput},
          {"firstDegraded", row.firstDegraded},
          {"promoted", row.promoted},
          {"replaysExactly", row.replaysExactly},
          {"bandsExactly", row.bandsExactly},
          {"tilesExactly", row.tilesExactly},
          {"worstScaling", row.worstScaling},
          {"litFromBlack", row.litFromBlack},
          {"worstSkip", row.worstSkip}};
}

}  // namespace

std::string plainText(const StressReport& found) { return report(found, aligned); }
std::string markdownText(const StressReport& found) { return report(found, markdown); }

std::string jsonText(const StressReport& report) {
  Json json{{"version", XRDS_VERSION},
            {"seed", report.seed},
            {"cases", report.cases()},
            {"fp32Bound", report.fp32Bound},
            {"fp16Bound", report.fp16Bound},
            {"fp32ScalingBound", report.fp32ScalingBound},
            {"fp16ScalingBound", report.fp16ScalingBound},
            {"colours", report.colours},
            {"auxiliaries", report.auxiliaries}};
  for (const auto& [name, definition] : kDefinitions) json["definitions"][name] = definition;
  json["rows"] = json["operators"] = json["exceptions"] = Json::array();
  for (const StressRow& row : report.rows) json["rows"].push_back(jsonOf(row));
  for (const StressOperator& op : report.operators)
    json["operators"].push_back({{"name", op.name},
                                 {"precision", op.precision},
                                 {"family", op.family},
                                 {"worstError", op.worstError},
                                 {"budget", op.budget},
                                 {"where", op.where}});
  for (const std::string& exception : report.exceptions()) json["exceptions"].push_back(exception);
  return textOf(json);
}

}  // namespace xrds
