#include "app/pixel_size.h"

#include <charconv>

#include "app/exit_code.h"

namespace xrds {

PixelSize parsePixelSize(const std::string& text, const std::string& option, uint32_t least, uint32_t most) {
  PixelSize size;
  const char* const end = text.data() + text.size();
  const auto [times, first] = std::from_chars(text.data(), end, size.width);
  if (first == std::errc() && times != end && *times == 'x') {
    const auto [rest, second] = std::from_chars(times + 1, end, size.height);
    const auto fits = [&](uint32_t side) { return side >= least && side <= most; };
    if (second == std::errc() && rest == end && fits(size.width) && fits(size.height)) return size;
  }
  throw Failure{ExitCode::usage, option + " takes WIDTHxHEIGHT, such as 1920x1080, of " + std::to_string(least) +
                                     " to " + std::to_string(most) + " pixels each, found '" + text + "'."};
}

}  // namespace xrds
