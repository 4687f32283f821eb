#pragma once

#include "engine/tensor.h"

namespace xrds {

/// How far a kernel may be from its reference, both relative to the RMS of the reference.
struct Tolerance {
  double rms = 0, max = 0;
};

/// The one tolerance of each storage type.
constexpr Tolerance toleranceOf(DataType type) {
  return type == DataType::f32 ? Tolerance{1e-5, 1e-4} : Tolerance{1e-3, 1e-2};
}

}  // namespace xrds
