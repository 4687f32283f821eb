#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace xrds {

/// As every JSON file is written: indented by two, bytes that are no UTF-8 replaced, a line's end behind it.
inline std::string textOf(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace xrds
