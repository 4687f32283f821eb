#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace xrds {

/// The SPIR-V of the tracer's programs by name; empty if there is none.
std::span<const uint32_t> tracerProgram(std::string_view name);

}  // namespace xrds
