#pragma once

#include "cli/bench/network_measurement.h"

namespace xrds {

/// One case and what was measured.
struct NetworkRow {
  NetworkCase networkCase;
  NetworkMeasurement measurement;
};

/// How exact one model is on one device in one precision; its case has no size.
struct AccuracyRow {
  NetworkCase networkCase;
  std::optional<EngineError> engine;
  std::optional<ImageError> image;
};

/// All that a run of `xrds bench network` found out.
struct NetworkReport {
  int runs = 0;
  std::string scenes;  // the folder; empty without one
  std::vector<Device::Description> devices;
  std::vector<NetworkRow> networks;
  std::vector<AccuracyRow> accuracies;
};

/// Two tables for a terminal: times and memory, and errors.
std::string plainText(const NetworkReport& report);

/// Every number with its definition.
std::string jsonText(const NetworkReport& report);

}  // namespace xrds
