#pragma once

#include <filesystem>
#include <string>

#include "tests/cli/process.h"

namespace xrds::test {

/// Lets xrds meet faults of its device; `rules` as in tests/faults/faults.h.
StartOptions withFaults(const std::string& rules, const std::filesystem::path& log = {});

/// Makes lavapipe a driver such as MoltenVK, which the loader hides from programs that do not ask for such ones and
/// which wants VK_KHR_portability_subset enabled. Writes into `folder`, which must stay. False if the machine has no
/// lavapipe.
bool makePortabilityDriver(StartOptions& options, const std::filesystem::path& folder);

/// Adds a second device like the first. Writes into `folder`, which must stay. False if the machine has no lavapipe.
bool addSecondDevice(StartOptions& options, const std::filesystem::path& folder);

}  // namespace xrds::test
