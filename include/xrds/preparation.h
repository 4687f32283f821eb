#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace xrds {

/// How far a device is with the programs that it lacks for what was asked of it.
struct Preparation {
  enum class Phase : uint8_t {
    pipelines,    // the driver reads and optimizes programs, at every start: seconds at most
    machineCode,  // a CPU driver compiles what its cache does not hold: minutes on a slow machine, once
  };
  Phase phase = Phase::pipelines;
  size_t done = 0, total = 0;  // programs
};

/// Called in the thread that prepares, ten times a second and at the end of a phase. Returning false cancels: what was
/// being made ends with Cancelled, as soon as the programs being compiled are (the driver cannot be stopped).
using PreparationProgress = std::function<bool(const Preparation&)>;

}  // namespace xrds
