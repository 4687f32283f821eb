#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/recording.h"
#include "frames/frame_input.h"
#include "network/network_model.h"

namespace xrds {

/// What a frame shape needs of a device's memory, in bytes: a question that needs no device.
struct MemoryNeeds {
  uint64_t planned = 0;     // the arena
  uint64_t lowerBound = 0;  // largest live set
  uint64_t unaliased = 0;   // every value with bytes of its own
  uint64_t weights = 0;     // packed
};
MemoryNeeds memoryNeeds(const Graph& graph, const DeviceTraits& device);

/// Throws Error, naming the limit, if the device cannot bind a tensor of the graph.
void checkBindings(const Graph& graph, const DeviceTraits& device);

/// The bytes of the arena that a session of the graph allocates.
uint64_t arenaByteSize(const Graph& graph);

class Session;

/// How a frame is planned and recorded.
struct SessionOptions {
  Precision precision = Precision::fp32;
  bool autoExposure = true;
  bool timestamps = false;
  uint64_t multiplyAddsPerSubmission = RecordingOptions{}.multiplyAddsPerSubmission;
  uint32_t bandRows = 0;                 // as in GraphOptions
  std::optional<KernelFamily> family{};  // in place of the device's
  uint64_t memoryBytes = 0;              // that a GPU's bands may reckon with; 0: all that the device has
  KernelTable kernels{};                 // as in GraphOptions
  uint32_t layers = 0;                   // as in GraphOptions
  bool aliasing = true;                  // off: every value keeps its bytes, so that each can be looked at
  /// A session that must outlive this one. Reuses its weights if they are the same, and its arena if that is large
  /// enough: never run both at once.
  const Session* lender = nullptr;
};

/// Names packed weights: the program that reads them, and the weights that they are made of as the model has them.
struct PackedKey {
  std::string program;
  const float *weight = nullptr, *first = nullptr;     // first: of a map joined to the layer's own
  uint32_t firstOutput = 0;                            // of a layer that is made in parts
  KernelShape shape{};                                 // asked of the kernel
  auto operator<=>(const PackedKey&) const = default;  // NOLINT(modernize-use-nullptr): no null pointer is written
};

/// What one dispatch does, and the device time that it took.
struct DispatchTime {
  std::string label, program;
  uint64_t multiplyAdds = 0, byteSize = 0;
  double microseconds = 0;
};

/// Of dispatches, by the times that a recording of them has taken.
std::vector<DispatchTime> timesOf(std::span<const PlacedDispatch> dispatches, std::span<const double> microseconds);

/// A model made ready for one frame shape on one device: planned and recorded once, replayed for each frame.
class Session {
 public:
  /// Throws Error if the device cannot hold the plan. The device must outlive the session.
  Session(Gpu& gpu, const NetworkModel& model, FrameShape frame, SessionOptions options = {});
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Upscales one frame into output [s h, s w, 3]. Throws Error if an image is of another size. `progress` as in
  /// Recording::run; returns false if it stopped the run.
  bool run(const FrameInput& input, std::span<float> output, const std::function<bool(size_t, size_t)>& progress = {});

  /// The three steps of run(), for frames whose inputs or output stay on the device. upload() writes the inputs to
  /// where placeOf() says; replay() reads them there and may overwrite them.
  void upload(const FrameInput& input);
  /// Uploads the part of a larger frame whose upper left low-resolution pixel is (x, y); its columns are cyclic.
  void uploadPart(const FrameInput& frame, int64_t x, uint32_t y);
  bool replay(const std::function<bool(size_t, size_t)>& progress = {}) { return recording_->run(progress); }
  void download(std::span<float> output) const;
  /// Hands over the rows of the last run's output: four floats a pixel, the last one not 0 where the network's share
  /// was not finite and is missing. Several threads at once, each for other rows, as in Buffer::downloadRows().
  void downloadRows(const std::function<void(uint32_t row, std::span<const float> pixels)>& read) const;
  /// Hands over the rows of what the kernels of the base made of a layer, four floats a pixel.
  void downloadLayerRows(size_t layer,
                         const std::function<void(uint32_t row, std::span<const float> pixels)>& read) const;
  /// Byte offset of an input or the output of the graph in arena().
  uint64_t placeOf(const TensorView& view) const { return plan_.offsets[storage_[view.value]]; }
  const Buffer& arena() const { return *arena_; }

  const Graph& graph() const { return graph_; }
  /// What a replay runs, for recordings of another program; valid as long as the session lives.
  std::span<const PlacedDispatch> dispatches() const { return placed_; }
  const MemoryPlan& plan() const { return plan_; }
  /// Between runs its bytes are free for other uses.
  Buffer& arena() { return *arena_; }
  uint64_t weightByteSize() const { return weights_->byteSize(); }
  /// Bytes of device memory that this session holds itself, not lent to it.
  uint64_t ownByteSize() const;
  size_t barrierCount() const { return recording_->barrierCount(); }
  /// Per dispatch, of the last run; needs timestamps.
  std::vector<DispatchTime> times() const;
  /// The elements of a value after a run, widened to float; what aliasing has overwritten is gone.
  std::vector<float> read(const TensorView& view) const;
  /// Fills the arena with a bit pattern (tests: NaN).
  void fillArena(uint32_t pattern) { arena_->fill(pattern); }
  /// Pixels of the last download's output without the network's share, which was not finite there, row by row from 0.
  const std::vector<uint64_t>& lostPixels() const { return lostPixels_; }
  /// The exposure that the last run used.
  float exposure() const;

 private:
  void readRows(const TensorView& view, const std::function<void(uint32_t, std::span<const float>)>& read) const;

  Graph graph_;
  std::vector<ValueId> storage_;
  MemoryPlan plan_;
  std::vector<PlacedDispatch> placed_;
  std::optional<Buffer> ownArena_, ownWeights_;
  Buffer *arena_ = nullptr, *weights_ = nullptr;  // the own ones or the lender's
  std::vector<PackedKey> packedKeys_;             // what the weights hold, in order
  std::optional<Recording> recording_;
  mutable std::vector<uint64_t> lostPixels_;  // found by download()
};

/// Opens a session of the frame. Where the device has no room for it, one whose bands are as narrow as bands can be,
/// unless the options choose them: slower, but the same picture. Throws OutOfMemory if that does not fit either.
void openSession(std::optional<Session>& session, Gpu& gpu, const NetworkModel& model, FrameShape frame,
                 SessionOptions options);

}  // namespace xrds
