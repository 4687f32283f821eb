#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace xrds {

/// Declares --quiet, which means the same for every command that has it.
inline void addQuiet(CLI::App& verb, bool& quiet) {
  verb.add_flag("--quiet", quiet, "Print nothing but warnings and errors");
}

/// Declares --device of a command that takes one.
inline void addDevice(CLI::App& verb, std::string& device) {
  verb.add_option("--device", device, "Number, part of the name, or UUID (see xrds devices)")->type_name("DEVICE");
}

}  // namespace xrds
