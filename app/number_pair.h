#pragma once

#include <optional>
#include <string>
#include <utility>

namespace xrds {

/// The two positive numbers of "64,16"; nothing if the text is none.
std::optional<std::pair<double, double>> parsePair(const std::string& text);

/// Empty if the text is two positive numbers with a comma between them, else what is wrong with it.
std::string validPair(const std::string& text);

}  // namespace xrds
