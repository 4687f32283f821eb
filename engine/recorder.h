#pragma once

#include <map>
#include <tuple>

#include "engine/handles.h"
#include "engine/recording.h"

namespace xrds {

/// Dispatches with all that recording them takes: pipelines, descriptor sets, and the barriers that their byte ranges
/// need. They may be recorded any number of times. The buffers must outlive it and stay where they are.
class Recorder {
 public:
  /// Throws as Recording's constructor does.
  Recorder(Gpu& gpu, std::span<const PlacedDispatch> asked);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  std::span<const PlacedDispatch> dispatches() const { return dispatches_; }
  /// Whether a barrier stands before each of them.
  const std::vector<bool>& barriers() const { return barriers_; }

  /// Records dispatches [begin, end). The first needs no barrier: what is before it is the caller's. `stamp`, if given,
  /// is called behind each, which then waits for the one before.
  void record(VkCommandBuffer commands, size_t begin, size_t end,
              const std::function<void(VkPipelineStageFlagBits)>& stamp = {}) const;

 private:
  using ViewKey = std::tuple<VkBuffer, uint64_t, uint64_t, VkFormat>;
  void makePool();
  void release();
  VkBufferView viewOf(const ByteRange& range, VkFormat format);
  VkDescriptorSet describe(const PlacedDispatch& placed);
  void barrierBetween(VkCommandBuffer commands) const;
  void moveLayout(VkCommandBuffer commands, const HostImage& image, VkImageLayout from, VkImageLayout to) const;
  void recordImageCopy(VkCommandBuffer commands, const ByteRange& from, const ByteRange& to) const;
  void recordCopy(VkCommandBuffer commands, const PlacedDispatch& placed) const;

  Gpu::Handles& gpu_;
  std::vector<PlacedDispatch> dispatches_;
  std::vector<bool> barriers_;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  std::map<ViewKey, VkBufferView> views_;
  std::vector<VkDescriptorSet> sets_;  // by dispatch; null: a copy
};

/// Dispatches [begin, end) that are submitted together.
struct WorkPiece {
  size_t begin = 0, end = 0;
  uint64_t work = 0;
};

/// The dispatches cut into pieces of at most that much work, or of one dispatch.
std::vector<WorkPiece> cutWork(std::span<const PlacedDispatch> dispatches, uint64_t mostWork);

}  // namespace xrds
