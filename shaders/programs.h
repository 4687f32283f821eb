#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace xrds {

/// The SPIR-V of an embedded program, such as "layer_norm_plain_f32"; empty if there is none of that name.
std::span<const uint32_t> embeddedProgram(std::string_view name);

}  // namespace xrds
