#include "image/layers/cycles_text.h"

namespace xrds {

std::optional<std::string> cyclesText(const ExrAttributes& attributes, const std::string& layer,
                                      const std::string& what) {
  const std::string start = "cycles.", end = "." + what;
  for (size_t dot = layer.rfind('.'); dot != std::string::npos && dot > 0; dot = layer.rfind('.', dot - 1))
    if (auto text = attributes.text(start + layer.substr(0, dot) + end)) return text;
  std::optional<std::string> found;
  for (const std::string& name : attributes.names()) {
    if (!name.starts_with(start) || !name.ends_with(end)) continue;
    const auto text = attributes.text(name);
    if (found && text && *text != *found) return {};
    if (text) found = text;
  }
  return found;
}

}  // namespace xrds
