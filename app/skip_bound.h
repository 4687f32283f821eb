#pragma once

#include <string>

namespace xrds {

/// What --skip takes, for CLI::Validator: empty if `text` is "off", "safe" or a bound in (0, 1], else what is wrong.
std::string validSkip(const std::string& text);

/// The bound that a valid text stands for; 0 for "off".
float parseSkip(const std::string& text);

}  // namespace xrds
