#pragma once

#include "xrds/precision.h"
#include "xrds/stress.h"

namespace xrds {
namespace call {

inline std::vector<std::string> texts(const char* const* list, uint32_t count) { return {list, list + count}; }

inline StressRow stressRow(const XrdsStressRow& row) {
  StressRow found{.model = row.model,
                  .weights = row.weights,
                  .precision = row.precision,
                  .family = row.family,
                  .bounded = row.bounded != 0,
                  .cases = row.cases,
                  .nonFiniteOutputs = row.nonFiniteOutputs,
                  .casesInParts = row.casesInParts,
                  .repairedPixels = row.repairedPixels,
                  .lostPixels = row.lostPixels,
                  .naturalCases = row.naturalCases,
                  .worstError = row.worstError,
                  .worstInput = row.worstInput,
                  .firstDegraded = row.firstDegraded,
                  .promoted = texts(row.promoted, row.promotedCount)};
  found.replaysExactly = row.replaysExactly != 0;
  found.bandsExactly = row.bandsExactly != 0;
  found.tilesExactly = row.tilesExactly != 0;
  found.worstScaling = row.worstScaling;
  found.litFromBlack = row.litFromBlack;
  found.worstSkip = row.worstSkip;
  return found;
}

inline StressReport stressReport(const XrdsStressReport& found) {
  StressReport report{.seed = found.seed,
                      .fp32Bound = found.fp32Bound,
                      .fp16Bound = found.fp16Bound,
                      .fp32ScalingBound = found.fp32ScalingBound,
                      .fp16ScalingBound = found.fp16ScalingBound,
                      .colours = texts(found.colours, found.colourCount),
                      .auxiliaries = texts(found.auxiliaries, found.auxiliaryCount)};
  for (uint32_t i = 0; i < found.rowCount; ++i) report.rows.push_back(stressRow(*found.rows[i]));
  for (uint32_t i = 0; i < found.operatorCount; ++i) {
    const XrdsStressOperator& op = *found.operators[i];
    report.operators.push_back({op.name, op.precision, op.family, op.worstError, op.budget, op.where});
  }
  return report;
}

}  // namespace call

inline StressReport Upscaler::stress(Device& device, const StressOptions& options) {
  std::vector<const char*> names;
  std::vector<const XrdsModel*> models;
  for (const auto& [name, model] : options.models) {
    names.push_back(name.c_str());
    models.push_back(model ? model->handle() : nullptr);
  }
  XrdsStressOptions asked = xrdsStressOptionsDefault();
  asked.modelCount = static_cast<uint32_t>(models.size());
  asked.names = names.data();
  asked.models = models.data();
  asked.randomModels = options.randomModels;
  asked.seed = options.seed;
  asked.shortForm = options.shortForm;
  call::Heard progress(options.progress);
  if (options.progress) asked.progress = decltype(progress)::template hear<double>;
  asked.user = progress.user();
  StressReport report;
  const auto take = [&](const XrdsStressReport* found) { report = call::stressReport(*found); };
  call::Heard heard(take);
  const XrdsResult result =
      xrdsStress(device.handle(), &asked, decltype(heard)::template listen<const XrdsStressReport*>, heard.user());
  progress.finish(XRDS_OK);
  heard.finish(XRDS_OK);
  device.finish(result);
  return report;
}

inline uint64_t StressReport::cases() const {
  uint64_t sum = 0;
  for (const StressRow& row : rows) sum += row.cases;
  return sum;
}

inline std::vector<std::string> StressReport::exceptions() const {
  const auto number = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", value);
    return std::string(text);
  };
  std::vector<std::string> found;
  for (const StressRow& row : rows) {
    const std::string what = row.model + ", weights " + row.weights + ", " + row.precision + ", " + row.family + ": ";
    const double bound = row.precision == kFp32 ? fp32Bound : fp16Bound;
    if (row.nonFiniteOutputs > 0)
      found.push_back(what + std::to_string(row.nonFiniteOutputs) + " of " + std::to_string(row.cases) +
                      " outputs are not finite.");
    if (!row.replaysExactly) found.push_back(what + "a replay gave other bits.");
    if (!row.tilesExactly) found.push_back(what + "exact tiles gave other bits than one piece.");
    if (!row.bandsExactly) found.push_back(what + "bands of rows gave other bits than one piece.");
    if (row.litFromBlack > 0)
      found.push_back(what + std::to_string(row.litFromBlack) + " pixels of black frames are lit.");
    if (!row.bounded) continue;
    const double scalingBound = row.precision == kFp32 ? fp32ScalingBound : fp16ScalingBound;
    if (!(row.worstScaling <= scalingBound))
      found.push_back(what + "scaling the colour changes the result by " + number(row.worstScaling) + ", more than " +
                      number(scalingBound) + ".");
    if (!(row.worstError <= bound))
      found.push_back(what + "the error " + number(row.worstError) + " exceeds " + number(bound) + " on '" +
                      row.worstInput + "'.");
    if (row.lostPixels > 0)
      found.push_back(what + "the network was not finite at " + std::to_string(row.lostPixels) + " pixels.");
  }
  for (const StressOperator& op : operators)
    if (!(op.worstError <= op.budget))
      found.push_back("Operator " + op.name + " in " + op.precision + ", " + op.family + ": the error " +
                      number(op.worstError) + " exceeds its budget " + number(op.budget) + " at " + op.where + ".");
  return found;
}

}  // namespace xrds
