#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "image/exr/file.h"

namespace xrds {

/// One render and the seconds that it took.
struct TimedRender {
  double seconds = 0, samples = 0;  // samples a pixel
  size_t pixels = 0;
};

/// What a render of the scene takes.
struct RenderCost {
  double start = 0;      // seconds before the first sample: reading the scene, building what rays are traced in
  double perSample = 0;  // seconds of one sample of one pixel

  double seconds(double samples, size_t pixels) const {
    return start + perSample * samples * static_cast<double>(pixels);
  }
};

/// The cost on which both renders lie; where that would give a negative start or nothing for a sample, one without a
/// start, of both renders' seconds over their samples. Throws Error unless all numbers are positive.
RenderCost renderCost(const TimedRender& one, const TimedRender& other);

/// The seconds that the render of a layer of the part took in all, as Cycles writes them
/// ("cycles.VIEWLAYER.total_time"), where it did and they are not 0.
std::optional<double> secondsOf(const ExrPart& part, const std::string& layer);

/// Seconds of "1.52", "00:01.52" or "1:02:03.4", as Cycles writes durations; nothing if the text is none.
std::optional<double> parseDuration(const std::string& text);

}  // namespace xrds
