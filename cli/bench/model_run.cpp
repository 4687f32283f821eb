#include "cli/bench/model_run.h"

#include <nlohmann/json.hpp>
#include <thread>

#include "cli/device_json.h"

namespace xrds {

nlohmann::ordered_json jsonOf(const ModelRun& run, std::span<const std::pair<const char*, const char*>> definitions) {
  nlohmann::ordered_json json{{"version", XRDS_VERSION},
                              {"processors", std::thread::hardware_concurrency()},
                              {"folder", run.folder},
                              {"model", run.model},
                              {"modelHash", run.modelHash},
                              {"precision", run.precision},
                              {"scale", run.setting.scale},
                              {"colourSamples", run.setting.colourSamples},
                              {"auxSamples", run.setting.auxSamples.value()}};
  for (const auto& [name, definition] : definitions) json["definitions"][name] = definition;
  json["devices"].push_back(jsonOf(run.device));
  return json;
}

}  // namespace xrds
