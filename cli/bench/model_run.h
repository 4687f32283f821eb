#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <utility>

#include "cli/bench/quality_scenes.h"
#include "xrds/xrds.hpp"

namespace xrds {

/// What a benchmark ran: one model on the scenes of a folder.
struct ModelRun {
  std::string folder, model, modelHash, precision;
  QualitySetting setting;  // with samples of the auxiliary images
  Device::Description device;
};

/// The same as the head of a JSON report, with what each of its numbers means.
nlohmann::ordered_json jsonOf(const ModelRun& run, std::span<const std::pair<const char*, const char*>> definitions);

}  // namespace xrds
