#pragma once

#include "engine/handles.h"

namespace xrds {

/// A device that compiles and runs nothing: RADV's null device, on which fences and submissions fail.
class NullDevice {
 public:
  /// The first device that Vulkan lists, with the programs of that source. Throws Error if there is none.
  explicit NullDevice(ProgramSource programs);

  const DeviceDescription& description() const { return handles_.description; }
  /// Whether it has what the family needs.
  bool runs(KernelFamily family) const;
  /// Takes the family for what follows, and returns the traits with which work is dispatched.
  DeviceTraits& take(KernelFamily family);
  Gpu::Handles& handles() { return handles_; }

 private:
  Gpu::Handles handles_;
};

}  // namespace xrds
