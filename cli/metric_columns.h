#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "image/metrics/metrics.h"

namespace xrds {

/// A metric under its name in tables and in JSON files, with the printf format of the tables.
struct MetricColumn {
  const char *title, *key;
  double Metrics::*field;
  const char* format;
};

/// All metrics, in the order of the tables.
std::span<const MetricColumn> metricColumns();

/// Every metric under its key; null where it is infinite.
nlohmann::ordered_json jsonOf(const Metrics& metrics);

}  // namespace xrds
