#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "image/image.h"
#include "viewer/vulkan/buffer.h"

namespace xrds {

/// The images of a frame that can be looked at.
enum class Slot : uint8_t {
  input,
  auxiliary,
  output,
  bicubic,
  demodulated,
  guided,
  reference,
  heat,
  skipMap,
  flicker,
  denoised
};
inline constexpr size_t kSlotCount = 11;

/// An image in device memory, [height, planes, width, 4] floats: each row has those of its planes one after the other.
/// `valid` once it belongs to the frame that is shown.
struct PictureView {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkBufferView texels = VK_NULL_HANDLE;
  uint32_t width = 0, height = 0, planes = 0;
  uint64_t byteSize() const { return uint64_t{16} * width * height * planes; }
  bool valid = false;
};

/// A copy on the device that renews a picture: from the begin of a buffer.
struct PictureSource {
  Slot slot;
  const DeviceBuffer* buffer;
};

/// Images that one thread renews, on the device, while another draws them. Each picture that is drawn is a whole one,
/// because a copy is one submission and so is a drawing.
class Pictures {
 public:
  explicit Pictures(VulkanDevice& gpu) : gpu_(gpu) {}
  ~Pictures();
  Pictures(const Pictures&) = delete;
  Pictures& operator=(const Pictures&) = delete;

  /// For the renewing thread. A slot of another size gets new memory and is invalid until it is filled.
  void resize(Slot slot, uint32_t width, uint32_t height, uint32_t planes);
  /// Copies whole pictures, as one step for those who draw.
  void copy(std::span<const PictureSource> sources);
  /// Gives the slot memory of its own with these pixels.
  void upload(Slot slot, uint32_t width, uint32_t height, uint32_t planes, std::span<const float> pixels);
  /// The same with the first three channels of an image.
  void upload(Slot slot, const Image& image);
  void invalidate(Slot slot);
  uint64_t byteSize() const;

  /// For the drawing thread: held from looking at the pictures to the submission of what reads them.
  std::unique_lock<std::mutex> hold() { return std::unique_lock(mutex_); }
  PictureView at(Slot slot) const { return picture(slot).view; }

 private:
  struct Picture {
    std::unique_ptr<DeviceBuffer> memory;
    PictureView view;
  };
  Picture& picture(Slot slot) { return pictures_[static_cast<size_t>(slot)]; }
  const Picture& picture(Slot slot) const { return pictures_[static_cast<size_t>(slot)]; }
  Picture make(uint32_t width, uint32_t height, uint32_t planes);
  void replace(Slot slot, Picture fresh);

  VulkanDevice& gpu_;
  std::array<Picture, kSlotCount> pictures_;
  mutable std::mutex mutex_;
};

}  // namespace xrds
