#pragma once

#include "app/exit_code.h"
#include "xrds/error.h"

namespace xrds {

/// Runs an action and returns its result; an Error in it becomes a Failure, which ends the process with that code.
template <class Action>
auto failingWith(ExitCode code, Action&& action) {
  try {
    return action();
  } catch (const Error& error) {
    throw Failure{code, error.what()};
  }
}

}  // namespace xrds
