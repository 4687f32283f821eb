#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/buffer.h"
#include "engine/device.h"
#include "engine/dispatch.h"

namespace xrds {

struct HostImage;  // engine/host_device.h

/// Where one binding of a dispatch lies: bytes of a buffer, to its end if byteSize is 0. Offsets are multiples of
/// kBindingAlignment. Of a copy one may be all pixels of an image, four numbers each, whose byteSize they take.
struct ByteRange {
  const Buffer* buffer = nullptr;
  uint64_t byteOffset = 0, byteSize = 0;
  const HostImage* image = nullptr;
};

/// A dispatch whose bindings have been given their place: ranges[i] belongs to dispatch.bindings[i], whose own offset
/// and size no longer count.
struct PlacedDispatch {
  Dispatch dispatch;
  std::vector<ByteRange> ranges;
};

/// How a list of dispatches is recorded and run.
struct RecordingOptions {
  bool timestamps = false;  // each dispatch then waits for the one before
  /// A submission holds at most that much work (see workOf()) or one dispatch, and no more than the device does in
  /// kSubmissionSeconds by its measured pace, so that none runs past a driver's watchdog or keeps others waiting.
  uint64_t multiplyAddsPerSubmission = uint64_t{16} << 30;
  /// Its runs measure the device's pace: for whole frames, not for kernels that are only tried.
  bool measuresPace = false;
};

/// Compiles the programs of the dispatches that are not compiled yet, many at once. Throws as Recording's constructor
/// does.
void compilePrograms(Gpu& gpu, std::span<const Dispatch* const> dispatches);

/// A list of dispatches, recorded with the barriers that their byte ranges need, and replayed at will. Recorded once,
/// and again after a run that showed the device to be of another pace than it was taken for. The buffers must outlive
/// it and stay where they are.
class Recording {
 public:
  /// Compiles the programs that are not compiled yet. Throws Error if Vulkan fails, std::logic_error if a dispatch
  /// breaks a limit of the device or names no program.
  Recording(Gpu& gpu, std::span<const PlacedDispatch> dispatches, RecordingOptions options = {});
  ~Recording();
  Recording(Recording&&) noexcept;
  Recording& operator=(Recording&&) noexcept;

  /// Submits everything and waits for the end. `progress`, if given, is called with the number of finished
  /// submissions and their total, and stops the run by returning false. Returns false if it was stopped.
  bool run(const std::function<bool(size_t, size_t)>& progress = {});

  /// Device time of each dispatch in the last run, in microseconds; empty without timestamps.
  std::vector<double> gpuMicroseconds() const;
  size_t barrierCount() const;

 private:
  struct Handles;
  class Flight;
  std::unique_ptr<Handles> handles_;
};

}  // namespace xrds
