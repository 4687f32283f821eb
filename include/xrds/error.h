#pragma once

#include <stdexcept>
#include <string>

namespace xrds {

/// A failure of the world around the library: a file, a device, an image of the wrong size. Its text is one
/// sentence that says what failed, what was expected and found, and what to do about it.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace xrds
