#pragma once

#include <functional>
#include <memory>
#include <string>

#include "xrds/xrds.hpp"

namespace xrds {

/// Warns on stderr of what the device notes.
void printNotes(const Device& device);

/// Opens the device that `select` names, the best one where it is empty. Shows on stderr, unless quiet, how far it is
/// with its programs. Throws Error, and Failure when interrupted.
std::unique_ptr<Device> openDevice(const std::string& select, bool quiet);

/// Runs the work on the device that `select` names. Where it is empty, on the best device, and after a failure of that
/// one on the next best, saying so on stderr: the work starts anew and must not have kept anything. Throws Failure
/// with ExitCode::device if the last device fails; other failures of the work end it.
/// Shows on stderr, unless quiet, how far a device is with its programs, and warns of what it notes.
void onDevice(const std::string& select, bool quiet, const std::function<void(Device&)>& work);

/// The kernel family with which commands run that name no device: of the best device, or "tile" where there is none.
std::string usualKernelFamily();

}  // namespace xrds
