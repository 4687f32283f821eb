#pragma once

#include <string>
#include <vector>

#include "engine/device.h"
#include "network/network_model.h"
#include "xrds/stress.h"

namespace xrds {

/// A model of a stress run and what it is called.
struct StressModel {
  std::string name;
  NetworkModel weights;
  bool large = false;  // not tried in every way
};

/// Runs the models, and random ones, with every change of weights in every precision and kernel family on every input.
/// Deterministic. Throws Error if the device fails.
StressReport runStress(Gpu& gpu, const std::vector<StressModel>& models, const StressOptions& options);

}  // namespace xrds
