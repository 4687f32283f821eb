#pragma once

#include <string>
#include <vector>

#include "xrds/tuning.h"

namespace xrds {

/// What came out of tuning one model.
struct TunedModel {
  std::string model;
  bool fp16 = false;
  uint32_t width = 0, height = 0;  // of the output
  Tuning::Report report{};
  double seconds = 0;  // that this took now
};

/// For a terminal: the operators where another kernel won, and what a frame gains.
std::string tuneText(const TunedModel& tuned);

/// As JSON, with every operator.
std::string tuneJson(const Device::Description& device, const std::vector<TunedModel>& tuned);

}  // namespace xrds
