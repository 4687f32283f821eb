#pragma once

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <string>

#include "xrds/xrds.hpp"

namespace xrds {

/// Declares --quiet, which means the same for every command that has it.
inline void addQuiet(CLI::App& verb, bool& quiet) {
  verb.add_flag("--quiet", quiet, "Print nothing but warnings and errors");
}

/// Declares --device of a command that takes one.
inline void addDevice(CLI::App& verb, std::string& device) {
  verb.add_option("--device", device, "Number, part of the name, or UUID (see xrds devices)")->type_name("DEVICE");
}

/// Declares --precision of a command that takes one.
inline void addPrecision(CLI::App& verb, std::string& precision) {
  verb.add_option("--precision", precision, "Storage of activations and weights")
      ->check(CLI::IsMember({kFp32, kFp16}))
      ->capture_default_str();
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

/// Declares --exposure, auto or a factor, of a command that takes one. `help`: what the factor does.
inline void addExposure(CLI::App& verb, std::string& exposure, const char* help) {
  const auto valid = [](const std::string& text) {
    char* end = nullptr;
    const float value = std::strtof(text.c_str(), &end);
    return text == "auto" || (*end == '\0' && Upscaler::isExposure(value))
               ? std::string()
               : "expected auto or a number from 1e-30 to 1e30, found '" + text + "'";
  };
  verb.add_option("--exposure", exposure, help)->check(CLI::Validator(valid, "auto|E"))->capture_default_str();
}

}  // namespace xrds
