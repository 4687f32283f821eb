#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/recording.h"

namespace xrds::test {

/// The SPIR-V of tests/programs/NAME.comp, or of a kernel for matrix units in software; empty if there is none.
std::span<const uint32_t> engineProgram(std::string_view name);

/// target = 2 source + add over `quads` vec4 of f32.
PlacedDispatch twicePlus(const Buffer& buffer, uint64_t sourceOffset, uint64_t targetOffset, uint32_t quads,
                         uint32_t add);

/// target = source, rounded from f32 to f16, over `quads` vec4.
PlacedDispatch toHalfs(const Buffer& buffer, uint64_t sourceOffset, uint64_t targetOffset, uint32_t quads);

std::vector<float> downloadFloats(const Buffer& buffer, uint64_t byteOffset, size_t count);
void uploadFloats(Buffer& buffer, uint64_t byteOffset, std::span<const float> numbers);

}  // namespace xrds::test
