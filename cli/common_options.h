#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "app/network_options.h"

namespace xrds {

/// Declares --quiet, which means the same for every command that has it.
inline void addQuiet(CLI::App& verb, bool& quiet) {
  verb.add_flag("--quiet", quiet, "Print nothing but warnings and errors");
}

/// Declares --json of a command whose report defines each of its numbers.
inline void addReportFile(CLI::App& verb, std::string& json) {
  verb.add_option("--json", json, "File to write with every number and its definition")->type_name("JSON");
}

/// Declares --samples and --aux of a benchmark on a folder of scenes.
inline void addSceneSamples(CLI::App& verb, int& colour, int& aux) {
  const auto add = [&](const char* name, int& samples, const char* help) {
    verb.add_option(name, samples, help)->check(CLI::PositiveNumber)->capture_default_str()->type_name("K");
  };
  add("--samples", colour, "Samples a pixel of the scenes' colour; at scale 1 those of --aux count");
  add("--aux", aux, "Samples a pixel of the scenes' albedo and normal");
}

}  // namespace xrds
