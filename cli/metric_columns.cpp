#include "cli/metric_columns.h"

#include <nlohmann/json.hpp>

namespace xrds {
namespace {

constexpr MetricColumn kColumns[] = {
    {"PSNR dB", "psnr", &Metrics::psnr, "%.3f"},
    {"RelMSE", "relMse", &Metrics::relMse, "%.4f"},
    {"trimmed", "relMseTrimmed", &Metrics::relMseTrimmed, "%.4f"},
    {"median", "relMseMedian", &Metrics::relMseMedian, "%.6f"},
    {"99.9 %", "relMsePercentile999", &Metrics::relMsePercentile999, "%.3f"},
    {"FLIP", "flip", &Metrics::flip, "%.4f"},
};

}  // namespace

std::span<const MetricColumn> metricColumns() { return kColumns; }

nlohmann::ordered_json jsonOf(const Metrics& metrics) {
  nlohmann::ordered_json json;
  for (const MetricColumn& column : kColumns) json[column.key] = metrics.*column.field;
  return json;
}

}  // namespace xrds
