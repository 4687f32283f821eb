#include "shaders/programs.h"

#include <utility>

namespace xrds {
namespace {
#include "embedded_programs.inc"
}  // namespace

std::span<const uint32_t> embeddedProgram(std::string_view name) {
  for (const auto& [key, words] : kPrograms)
    if (key == name) return words;
  return {};
}

}  // namespace xrds
