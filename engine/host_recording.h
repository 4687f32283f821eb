#pragma once

#include <volk.h>

#include <memory>
#include <span>

#include "engine/recording.h"

namespace xrds {

/// A semaphore of a timeline and a value of it.
struct TimelinePoint {
  VkSemaphore semaphore = VK_NULL_HANDLE;
  uint64_t value = 0;
};

/// Dispatches for another program's command buffers or queue, any number of which may be in flight: everything is made
/// by the constructor. The buffers must outlive it and stay where they are, and it what is in flight.
class HostRecording {
 public:
  /// Throws as Recording's constructor does.
  HostRecording(Gpu& gpu, std::span<const PlacedDispatch> dispatches);
  ~HostRecording();
  HostRecording(const HostRecording&) = delete;
  HostRecording& operator=(const HostRecording&) = delete;

  /// Records them into a primary command buffer outside of render passes, behind everything that was recorded or
  /// submitted before, and before everything after. From any thread.
  void recordInto(VkCommandBuffer commands) const;

  /// Submits them, in pieces of the work that Recording's have, and does not wait. Throws DeviceLost or OutOfMemory.
  void submit(std::span<const TimelinePoint> waits, std::span<const TimelinePoint> signals);

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

}  // namespace xrds
