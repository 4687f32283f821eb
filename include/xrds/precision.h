#pragma once

namespace xrds {

/// The names of what activations and weights are stored in, without and with Upscaler::Options::fp16.
inline constexpr const char* kFp32 = "fp32";
inline constexpr const char* kFp16 = "fp16";
constexpr const char* precisionName(bool fp16) { return fp16 ? kFp16 : kFp32; }

}  // namespace xrds
