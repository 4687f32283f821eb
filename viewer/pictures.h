#pragma once

#include <volk.h>

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "engine/buffer.h"
#include "engine/handles.h"

namespace xrds {

/// The images of a frame that can be looked at.
enum class Slot : uint8_t { input, auxiliary, output, bicubic, demodulated, guided, reference, heat, skipMap };
inline constexpr size_t kSlotCount = 9;

/// An image in device memory as texels: rows from the top, `channels` floats a pixel (a multiple of 4). `valid` once it
/// belongs to the frame that is shown.
struct PictureView {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkBufferView texels = VK_NULL_HANDLE;
  uint32_t width = 0, height = 0, channels = 0;
  bool valid = false;
};

/// A copy on the device that renews a picture: from an offset in a buffer.
struct PictureSource {
  Slot slot;
  VkBuffer buffer;
  uint64_t byteOffset;
};

/// Images that one thread renews, on the device, while another draws them. Each picture that is drawn is a whole one,
/// because a copy is one submission and so is a drawing.
class Pictures {
 public:
  explicit Pictures(Gpu& gpu) : gpu_(gpu) {}
  ~Pictures();
  Pictures(const Pictures&) = delete;
  Pictures& operator=(const Pictures&) = delete;

  /// For the renewing thread. A slot of another size gets new memory and is invalid until it is filled.
  void resize(Slot slot, uint32_t width, uint32_t height, uint32_t channels);
  /// Copies whole pictures, as one step for those who draw.
  void copy(std::span<const PictureSource> sources);
  /// Gives the slot memory of its own with these pixels.
  void upload(Slot slot, uint32_t width, uint32_t height, uint32_t channels, std::span<const float> pixels);
  void invalidate(Slot slot);
  uint64_t byteSize() const;

  /// For the drawing thread: held from looking at the pictures to the submission of what reads them.
  std::unique_lock<std::mutex> hold() { return std::unique_lock(mutex_); }
  PictureView at(Slot slot) const { return picture(slot).view; }

 private:
  struct Picture {
    std::unique_ptr<Buffer> memory;
    PictureView view;
  };
  Picture& picture(Slot slot) { return pictures_[static_cast<size_t>(slot)]; }
  const Picture& picture(Slot slot) const { return pictures_[static_cast<size_t>(slot)]; }
  Picture make(uint32_t width, uint32_t height, uint32_t channels);
  void replace(Slot slot, Picture fresh);

  Gpu& gpu_;
  std::array<Picture, kSlotCount> pictures_;
  mutable std::mutex mutex_;
};

}  // namespace xrds
