#include "advice/render_cost.h"

#include <cmath>

#include "image/layers/cycles_text.h"
#include "image/leading_number.h"
#include "xrds/error.h"

namespace xrds {

RenderCost renderCost(const TimedRender& one, const TimedRender& other) {
  for (const TimedRender* render : {&one, &other})
    if (!(render->seconds > 0) || !(render->samples > 0) || render->pixels == 0 || !std::isfinite(render->seconds) ||
        !std::isfinite(render->samples))
      throw Error("Seconds, samples and pixels of a render must be positive.");
  const double paths = one.samples * static_cast<double>(one.pixels);
  const double otherPaths = other.samples * static_cast<double>(other.pixels);
  const double perSample = (other.seconds - one.seconds) / (otherPaths - paths);
  const double start = one.seconds - perSample * paths;
  if (std::isfinite(perSample) && perSample > 0 && start >= 0) return {start, perSample};
  return {0, (one.seconds + other.seconds) / (paths + otherPaths)};
}

std::optional<double> secondsOf(const ExrPart& part, const std::string& layer) {
  const auto text = cyclesText(part.attributes, layer, "total_time");
  const std::optional<double> seconds = text ? parseDuration(*text) : std::nullopt;
  return seconds && *seconds > 0 ? seconds : std::nullopt;
}

std::optional<double> parseDuration(const std::string& text) {
  double seconds = 0;
  const char *at = text.data(), *end = at + text.size();
  for (int parts = 0; parts < 3; ++parts) {
    const auto part = leadingNumber(at, end, false);
    if (!part || part->value < 0) return {};
    seconds = 60 * seconds + part->value;
    if (part->end == end) return seconds;
    if (*part->end != ':') return {};
    at = part->end + 1;
  }
  return {};
}

}  // namespace xrds
