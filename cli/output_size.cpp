#include "cli/output_size.h"

#include <cstdio>

#include "app/failing_with.h"

namespace xrds {

OutputSize parseOutputSize(const std::string& text) {
  OutputSize size;
  char rest = 0;
  const bool isPlain = text.find_first_not_of("0123456789x") == std::string::npos;  // sscanf takes signs and spaces
  if (!isPlain || std::sscanf(text.c_str(), "%5ux%5u%c", &size.width, &size.height, &rest) != 2 || size.width == 0 ||
      size.height == 0)
    throw Failure{ExitCode::usage, "--size takes WIDTHxHEIGHT of the output, such as 1920x1080, found '" + text + "'."};
  return size;
}

}  // namespace xrds
