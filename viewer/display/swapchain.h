#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "viewer/display/display.h"
#include "viewer/vulkan/buffer.h"

namespace xrds {

/// What the display showed: 8-bit sRGB, rows from the top, 3 bytes a pixel.
struct Screenshot {
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> pixels;
};

/// The images of a display, which are remade whenever the desktop asks for it. Used by the main thread alone; it shares
/// the device's queue with other threads.
class Swapchain {
 public:
  /// Throws Error if the device cannot draw on the display. All must outlive the swapchain.
  Swapchain(VulkanDevice& gpu, const Display& display);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  VkRenderPass renderPass() const { return renderPass_; }
  uint32_t imageCount() const { return static_cast<uint32_t>(images_.size()); }
  VkExtent2D extent() const { return extent_; }

  /// Draws and shows one picture. `before` records outside the render pass, `inside` in it, whose viewport is the
  /// whole display. Returns false if the display has no area, or its images were lost twice in a row.
  using Record = std::function<void(VkCommandBuffer)>;
  bool draw(const Record& before, const Record& inside);
  /// Waits until what was drawn last is finished.
  void wait();
  /// Copies the next picture that is drawn for screenshot().
  void captureNext() { capturing_ = true; }
  const Screenshot& screenshot() const { return screenshot_; }
  /// As if the desktop had taken the images, or with them the surface; for tests.
  void lose(bool surfaceToo);
  uint32_t timesMade() const { return timesMade_; }

 private:
  struct Image {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    VkSemaphore drawn = VK_NULL_HANDLE;
  };
  void makeSurface();
  void makeRenderPass();
  void makeCommandObjects();
  void makeImages();
  void makeImage(Image& image) const;
  void destroyImages();
  void record(const Image& image, const Record& before, const Record& inside);
  void recordCapture(VkImage image);
  void keepScreenshot();
  bool acquire(uint32_t& index);
  void submit(const Image& image);
  void present(uint32_t index);

  VulkanDevice& gpu_;
  const Display& display_;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
  VkSurfaceFormatKHR format_{};
  VkRenderPass renderPass_ = VK_NULL_HANDLE;
  VkCommandPool commandPool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence finished_ = VK_NULL_HANDLE;
  VkSemaphore acquired_ = VK_NULL_HANDLE;
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  VkExtent2D extent_{};
  std::vector<Image> images_;
  std::unique_ptr<HostBuffer> capture_;
  Screenshot screenshot_;
  bool stale_ = false, capturing_ = false, canCapture_ = false;
  uint32_t timesMade_ = 0;
};

}  // namespace xrds
