#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>

#include "app/exit_code.h"
#include "xrds/xrds.hpp"

namespace xrds {

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

/// Declares --exposure, auto or a factor, of a command that takes one. `help`: what the factor does.
inline void addExposure(CLI::App& verb, std::string& exposure,
                        const char* help = "Factor that brings the colour to a mean log luminance of 0.18") {
  const auto valid = [](const std::string& text) {
    char* end = nullptr;
    const float value = std::strtof(text.c_str(), &end);
    return text == "auto" || (*end == '\0' && Upscaler::isExposure(value))
               ? std::string()
               : "expected auto or a number from 1e-30 to 1e30, found '" + text + "'";
  };
  verb.add_option("--exposure", exposure, help)->check(CLI::Validator(valid, "auto|E"))->capture_default_str();
}

/// What --exposure was given; nothing: auto.
inline std::optional<float> parseExposure(const std::string& text) {
  return text == "auto" ? std::nullopt : std::optional(std::strtof(text.c_str(), nullptr));
}

/// Declares --tiles, of frames that are cut into them.
inline void addTiles(CLI::App& verb, std::string& tiles) {
  verb.add_option("--tiles", tiles,
                  "exact: the picture is that of the whole frame bit for bit; bounded: a smaller halo, less work")
      ->check(CLI::IsMember({"exact", "bounded"}))
      ->capture_default_str();
}

/// Declares --temporal-radius and --motion, of frames that are merged with those around them; returns both.
inline std::array<CLI::Option*, 2> addTemporal(CLI::App& verb, std::optional<uint32_t>& radius, std::string& motion) {
  return {verb.add_option("--temporal-radius", radius,
                          "With --temporal: frames before and after that are used (default: 5; 10 while\nhalf of the "
                          "picture stands still)")
              ->check(CLI::Range(1, 16)),
          verb.add_option("--motion", motion,
                          "With --temporal: another layer of motion; of two channels: x to the right and y down from "
                          "the frame\nto the previous one, in pixels, which uses frames before alone")
              ->type_name("LAYER")};
}

/// Declares --wrap, of panoramas.
inline void addWrap(CLI::App& verb, bool& wrap) {
  verb.add_flag("--wrap", wrap, "The left and right edges continue into each other: a panorama");
}

/// Declares --ensemble. `more`: what else is to be said of it.
inline void addEnsemble(CLI::App& verb, uint32_t& passes, const std::string& more = "") {
  verb.add_option("--ensemble", passes,
                  "Passes whose mean is taken: 2, also turned by half a turn; 4, mirrored both ways; 8, also on the "
                  "diagonal. Better, and as many times slower; normals must be in the camera's axes" +
                      more)
      ->check(CLI::IsMember({"1", "2", "4", "8"}))
      ->capture_default_str();
}

/// Throws Failure where --wrap is given beside as many passes, or a bound of --skip, as panoramas do not take.
inline void requirePanorama(bool wrap, uint32_t passes, float skipBound) {
  if (wrap && passes == 8)
    throw Failure{ExitCode::usage, "--ensemble 8 and --wrap exclude each other: 4 leaves out the diagonal."};
  if (wrap && skipBound > 0)
    throw Failure{ExitCode::usage, "--skip and --wrap exclude each other: a panorama is computed in full."};
}

}  // namespace xrds
