#pragma once

#include <CLI/CLI.hpp>

namespace xrds {

/// Declares --quiet, which means the same for every command that has it.
inline void addQuiet(CLI::App& verb, bool& quiet) {
  verb.add_flag("--quiet", quiet, "Print nothing but warnings and errors");
}

}  // namespace xrds
