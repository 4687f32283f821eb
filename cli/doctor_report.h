#pragma once

#include <string>

#include "cli/verdict.h"

namespace xrds {

/// For a terminal: the device, a table of its kernels, the known frame, what is degraded, the verdict.
std::string doctorText(const Findings& findings, const Verdict& verdict);

/// Everything, as JSON.
std::string doctorJson(const Findings& findings, const Verdict& verdict);

}  // namespace xrds
