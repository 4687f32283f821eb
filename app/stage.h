#pragma once

#include "app/exit_code.h"
#include "xrds/error.h"

namespace xrds {

/// Runs one stage of a command; an Error in it ends the process with the stage's exit code.
template <class Action>
auto stage(ExitCode code, Action&& action) {
  try {
    return action();
  } catch (const Error& error) {
    throw Failure{code, error.what()};
  }
}

}  // namespace xrds
