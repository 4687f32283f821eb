#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace xrds {

/// The bound that loses at most 0.05 dB on every frame of bench/skip.md.
inline constexpr float kSafeSkip = 0.005f;

/// What an Upscaler need not compute.
struct SkipOptions {
  /// Not 0: windows of the frame are interpolated without the network where that changes them by at most this much,
  /// the root mean square of log(1 + exposure radiance): background, clear sky, even and converged surfaces.
  /// bench/skip.md has how it was measured.
  float bound = 0;
  /// Windows whose inputs, and those around them, are the same as in the run before keep their result: for sequences
  /// and live views. An exposure that is not given stays that of the first run until the frame's own differs by more
  /// than 2 %. With exact tiles the result is that of a full run bit for bit, for a given exposure.
  bool keepUnchanged = false;
};

/// What became of each attention window of a frame, from left to right and top to bottom.
struct SkipMap {
  enum class Window : uint8_t { computed, interpolated, kept };
  uint32_t side = 0;  // of a window, in pixels of the output; the last ones of a row or column may be smaller
  uint32_t columns = 0, rows = 0;
  std::vector<Window> windows{};
  double work = 1;  // pixels computed, with the surroundings that are needed, over pixels of the frame

  double share(Window which) const {
    size_t count = 0;
    for (const Window window : windows) count += window == which;
    return windows.empty() ? 0 : static_cast<double>(count) / static_cast<double>(windows.size());
  }
};

}  // namespace xrds
