#pragma once

#include <span>
#include <string_view>

#include "engine/device.h"

namespace xrds::bench {

/// The rates that a device reaches in the simplest kernels: what operators are compared with.
struct DevicePeaks {
  double flops = 0;  // of fp32 multiply-adds in registers, two each; matrix units take no part
  /// Read plus written, in the faster of copying and reading up to 128 MiB, on a CPU device also of 8 MiB, which stay
  /// in its caches.
  double bytesPerSecond = 0;
};

/// The SPIR-V of bench/programs/NAME.comp; empty if there is none.
std::span<const uint32_t> peakProgram(std::string_view name);

/// Takes about a second. The device's ProgramSource must know peakProgram(). Throws Error if a kernel gives a wrong
/// result.
DevicePeaks measurePeaks(Gpu& gpu);

}  // namespace xrds::bench
