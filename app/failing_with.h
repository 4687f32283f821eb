#pragma once

#include <exception>
#include <new>

#include "app/exit_code.h"
#include "xrds/error.h"

namespace xrds {

/// What was thrown, as what ends a program: a Failure itself, too little memory, anything else as a bug.
inline Failure failureOf(const std::exception_ptr& thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Failure& failure) {
    return failure;
  } catch (const std::bad_alloc&) {
    return {ExitCode::device, "The machine has not enough memory for this frame."};
  } catch (const std::exception& error) {
    return {ExitCode::bug, std::string("This is a bug of xrds: ") + error.what()};
  }
}

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
