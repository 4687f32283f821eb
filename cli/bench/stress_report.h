#pragma once

#include "xrds/stress.h"

namespace xrds {

/// Tables of models and operators for a terminal, and every exception; as Markdown on demand.
std::string plainText(const StressReport& report);
std::string markdownText(const StressReport& report);

/// Every number with its definition.
std::string jsonText(const StressReport& report);

}  // namespace xrds
