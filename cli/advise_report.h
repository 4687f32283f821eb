#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "advice/plans.h"

namespace xrds {

/// All that a run of `xrds advise` found out.
struct Advice {
  std::string low, full;      // files
  int width = 0, height = 0;  // of the frame at full resolution
  RenderSamples samples;      // of the two renders
  SceneFeatures scene;
  std::optional<RenderCost> cost{};  // with the following: of plans, if they were asked for
  std::string device;
  StepSeconds steps;
  std::set<int> unfitScales;   // of ways that are left out, as the frame's size is no multiple of theirs
  std::vector<Plan> plans;     // those worth their time, the quickest first
  std::optional<Plan> chosen;  // for what was asked
};

/// The scene, the plans and, where one was chosen, how to go about it. For a terminal.
std::string plainText(const Advice& advice);

/// Every number with its definition.
std::string jsonText(const Advice& advice);

}  // namespace xrds
