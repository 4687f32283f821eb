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

/// What the caller gave cannot be: an image of the wrong size, an option out of range.
class InvalidArgument : public Error {
 public:
  using Error::Error;
};

/// A device, or the memory that it may take, has no room for what was asked. Less may fit.
class OutOfMemory : public Error {
 public:
  using Error::Error;
};

/// A device stopped working, or did not answer for minutes. What was made on it is of no more use; another device may
/// do, or the same one opened again.
class DeviceLost : public Error {
 public:
  using Error::Error;
};

/// The caller stopped the preparation of a device or a frame (PreparationProgress). The device works on.
class Cancelled : public Error {
 public:
  using Error::Error;
};

}  // namespace xrds
