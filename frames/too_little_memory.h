#pragma once

#include "xrds/error.h"

namespace xrds {

/// The memory that is allowed has no room for a frame, not even in the smallest tiles. To callers of the library it is
/// OutOfMemory, which within it means that the device had less than it said and smaller tiles may do.
class TooLittleMemory : public Error {
 public:
  using Error::Error;
};

}  // namespace xrds
