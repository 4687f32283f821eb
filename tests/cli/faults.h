#pragma once

#include <filesystem>
#include <string>

#include "tests/cli/process.h"

namespace xrds::test {

/// Lets xrds meet faults of its device; `rules` as in tests/faults/faults.h.
StartOptions withFaults(const std::string& rules, const std::filesystem::path& log = {});

/// Adds a second device like the first. Writes into `folder`, which must stay. False if the machine has no lavapipe.
bool addSecondDevice(StartOptions& options, const std::filesystem::path& folder);

}  // namespace xrds::test
