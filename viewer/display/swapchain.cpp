#include "viewer/display/swapchain.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <mutex>

#include "xrds/error.h"

namespace xrds {
namespace {

VkSurfaceFormatKHR chooseFormat(const VulkanDevice& gpu, VkSurfaceKHR surface) {
  uint32_t count = 0;
  checkVulkan(vkGetPhysicalDeviceSurfaceFormatsKHR(gpu.physicalDevice, surface, &count, nullptr),
              "vkGetPhysicalDeviceSurfaceFormatsKHR");
  std::vector<VkSurfaceFormatKHR> formats(count);
  checkVulkan(vkGetPhysicalDeviceSurfaceFormatsKHR(gpu.physicalDevice, surface, &count, formats.data()),
              "vkGetPhysicalDeviceSurfaceFormatsKHR");
  // The shaders apply the sRGB curve, so the images must not.
  for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM})
    for (const VkSurfaceFormatKHR& format : formats)
      if (format.format == wanted && format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR) return format;
  throw Error("The desktop offers no 8-bit sRGB images to draw on.");
}

VkSemaphore makeSemaphore(const VulkanDevice& gpu) {
  const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  VkSemaphore semaphore = VK_NULL_HANDLE;
  checkVulkan(vkCreateSemaphore(gpu.device, &info, nullptr, &semaphore), "vkCreateSemaphore");
  return semaphore;
}

void memoryBarrier(VkCommandBuffer commands, VkPipelineStageFlags before, VkAccessFlags written,
                   VkPipelineStageFlags after, VkAccessFlags used) {
  VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  barrier.srcAccessMask = written;
  barrier.dstAccessMask = used;
  vkCmdPipelineBarrier(commands, before, after, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

bool lost(VkResult result) { return result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_ERROR_SURFACE_LOST_KHR; }

}  // namespace

Swapchain::Swapchain(VulkanDevice& gpu, const Display& display) : gpu_(gpu), display_(display) {
  makeSurface();
  makeRenderPass();
  makeCommandObjects();
  makeImages();
}

Swapchain::~Swapchain() {
  wait();
  destroyImages();
  vkDestroySwapchainKHR(gpu_.device, swapchain_, nullptr);
  vkDestroySemaphore(gpu_.device, acquired_, nullptr);
  vkDestroyFence(gpu_.device, finished_, nullptr);
  vkDestroyCommandPool(gpu_.device, commandPool_, nullptr);
  vkDestroyRenderPass(gpu_.device, renderPass_, nullptr);
  vkDestroySurfaceKHR(gpu_.instance, surface_, nullptr);
}

void Swapchain::makeSurface() {
  checkVulkan(glfwCreateWindowSurface(gpu_.instance, display_.window(), nullptr, &surface_), "glfwCreateWindowSurface");
  VkBool32 supported = VK_FALSE;
  checkVulkan(vkGetPhysicalDeviceSurfaceSupportKHR(gpu_.physicalDevice, gpu_.queueFamily, surface_, &supported),
              "vkGetPhysicalDeviceSurfaceSupportKHR");
  if (!supported)
    throw Error(std::string(gpu_.properties.deviceName) +
                " cannot draw on this desktop: choose another device with --device.");
  format_ = chooseFormat(gpu_, surface_);
}

void Swapchain::makeRenderPass() {
  VkAttachmentDescription image{};
  image.format = format_.format;
  image.samples = VK_SAMPLE_COUNT_1_BIT;
  image.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  image.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  image.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  image.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  image.finalLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
  const VkAttachmentReference reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &reference;
  // In: after the image was acquired. Out: before it is copied for a screenshot.
  const VkSubpassDependency dependencies[] = {
      {VK_SUBPASS_EXTERNAL, 0, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
       VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, 0, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT, 0},
      {0, VK_SUBPASS_EXTERNAL, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
       VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT, 0}};
  VkRenderPassCreateInfo info{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
  info.attachmentCount = 1;
  info.pAttachments = &image;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  info.dependencyCount = 2;
  info.pDependencies = dependencies;
  checkVulkan(vkCreateRenderPass(gpu_.device, &info, nullptr, &renderPass_), "vkCreateRenderPass");
}

void Swapchain::makeCommandObjects() {
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = gpu_.queueFamily;
  checkVulkan(vkCreateCommandPool(gpu_.device, &pool, nullptr, &commandPool_), "vkCreateCommandPool");
  VkCommandBufferAllocateInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  commands.commandPool = commandPool_;
  commands.commandBufferCount = 1;
  checkVulkan(vkAllocateCommandBuffers(gpu_.device, &commands, &commands_), "vkAllocateCommandBuffers");
  VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  fence.flags = VK_FENCE_CREATE_SIGNALED_BIT;
  checkVulkan(vkCreateFence(gpu_.device, &fence, nullptr, &finished_), "vkCreateFence");
  acquired_ = makeSemaphore(gpu_);
}

void Swapchain::makeImages() {
  wait();
  destroyImages();
  stale_ = false;
  VkSurfaceCapabilitiesKHR surface;
  checkVulkan(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(gpu_.physicalDevice, surface_, &surface),
              "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
  int width = 0, height = 0;
  glfwGetFramebufferSize(display_.window(), &width, &height);
  extent_ = surface.currentExtent;
  if (extent_.width == ~0u) extent_ = {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
  if (extent_.width == 0 || extent_.height == 0) return;

  canCapture_ = surface.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
  info.surface = surface_;
  info.minImageCount = std::max(surface.minImageCount, 2u);
  info.imageFormat = format_.format;
  info.imageColorSpace = format_.colorSpace;
  info.imageExtent = extent_;
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  if (canCapture_) info.imageUsage |= VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  info.preTransform = surface.currentTransform;
  info.compositeAlpha = surface.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                            ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                            : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
  info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
  info.clipped = VK_TRUE;
  info.oldSwapchain = swapchain_;
  const VkSwapchainKHR old = swapchain_;
  const VkResult made = vkCreateSwapchainKHR(gpu_.device, &info, nullptr, &swapchain_);
  vkDestroySwapchainKHR(gpu_.device, old, nullptr);
  if (made != VK_SUCCESS) swapchain_ = VK_NULL_HANDLE;
  checkVulkan(made, "vkCreateSwapchainKHR");

  uint32_t count = 0;
  checkVulkan(vkGetSwapchainImagesKHR(gpu_.device, swapchain_, &count, nullptr), "vkGetSwapchainImagesKHR");
  std::vector<VkImage> images(count);
  checkVulkan(vkGetSwapchainImagesKHR(gpu_.device, swapchain_, &count, images.data()), "vkGetSwapchainImagesKHR");
  for (const VkImage image : images) makeImage(images_.emplace_back(Image{image}));
  ++timesMade_;
}

void Swapchain::makeImage(Image& image) const {
  VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  view.image = image.image;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = format_.format;
  view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  checkVulkan(vkCreateImageView(gpu_.device, &view, nullptr, &image.view), "vkCreateImageView");
  VkFramebufferCreateInfo framebuffer{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
  framebuffer.renderPass = renderPass_;
  framebuffer.attachmentCount = 1;
  framebuffer.pAttachments = &image.view;
  framebuffer.width = extent_.width;
  framebuffer.height = extent_.height;
  framebuffer.layers = 1;
  checkVulkan(vkCreateFramebuffer(gpu_.device, &framebuffer, nullptr, &image.framebuffer), "vkCreateFramebuffer");
  image.drawn = makeSemaphore(gpu_);
}

void Swapchain::destroyImages() {
  if (!images_.empty()) {  // the fence says nothing of the presentation, which waits for a semaphore of them
    const std::lock_guard lock(gpu_.queueAccess);
    checkVulkan(vkQueueWaitIdle(gpu_.queue), "vkQueueWaitIdle");
  }
  for (const Image& image : images_) {
    vkDestroyFramebuffer(gpu_.device, image.framebuffer, nullptr);
    vkDestroyImageView(gpu_.device, image.view, nullptr);
    vkDestroySemaphore(gpu_.device, image.drawn, nullptr);
  }
  images_.clear();
}

void Swapchain::lose(bool surfaceToo) {
  stale_ = true;
  if (!surfaceToo) return;
  wait();
  destroyImages();
  vkDestroySwapchainKHR(gpu_.device, swapchain_, nullptr);
  swapchain_ = VK_NULL_HANDLE;
  vkDestroySurfaceKHR(gpu_.instance, surface_, nullptr);
  surface_ = VK_NULL_HANDLE;
  makeSurface();
}

void Swapchain::wait() {
  checkVulkan(vkWaitForFences(gpu_.device, 1, &finished_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
}

bool Swapchain::acquire(uint32_t& index) {
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (stale_ || images_.empty()) makeImages();
    if (images_.empty()) return false;
    const VkResult result =
        vkAcquireNextImageKHR(gpu_.device, swapchain_, UINT64_MAX, acquired_, VK_NULL_HANDLE, &index);
    if (result == VK_SUBOPTIMAL_KHR) stale_ = true;
    if (result == VK_SUCCESS || result == VK_SUBOPTIMAL_KHR) return true;
    if (!lost(result)) checkVulkan(result, "vkAcquireNextImageKHR");
    lose(result == VK_ERROR_SURFACE_LOST_KHR);
  }
  return false;
}

bool Swapchain::draw(const Record& before, const Record& inside) {
  wait();
  uint32_t index = 0;
  if (!acquire(index)) return false;
  record(images_[index], before, inside);
  submit(images_[index]);
  present(index);
  if (capturing_ && canCapture_) keepScreenshot();
  return true;
}

void Swapchain::record(const Image& image, const Record& before, const Record& inside) {
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  checkVulkan(vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer");
  constexpr VkPipelineStageFlags kNetwork = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  constexpr VkPipelineStageFlags kDrawing = VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  memoryBarrier(commands_, kNetwork, VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT, kDrawing,
                VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT);
  before(commands_);
  constexpr VkClearValue kBackground{{{0.11F, 0.11F, 0.11F, 1}}};
  VkRenderPassBeginInfo pass{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
  pass.renderPass = renderPass_;
  pass.framebuffer = image.framebuffer;
  pass.renderArea.extent = extent_;
  pass.clearValueCount = 1;
  pass.pClearValues = &kBackground;
  vkCmdBeginRenderPass(commands_, &pass, VK_SUBPASS_CONTENTS_INLINE);
  const VkViewport viewport{0, 0, static_cast<float>(extent_.width), static_cast<float>(extent_.height), 0, 1};
  const VkRect2D scissor{{}, extent_};
  vkCmdSetViewport(commands_, 0, 1, &viewport);
  vkCmdSetScissor(commands_, 0, 1, &scissor);
  inside(commands_);
  vkCmdEndRenderPass(commands_);
  if (capturing_ && canCapture_) recordCapture(image.image);
  // What comes next on the queue may overwrite the pictures, and the host reads copies.
  memoryBarrier(commands_, kDrawing, VK_ACCESS_TRANSFER_WRITE_BIT, kNetwork | VK_PIPELINE_STAGE_HOST_BIT,
                VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_HOST_READ_BIT);
  checkVulkan(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
}

void Swapchain::recordCapture(VkImage image) {
  capture_ = std::make_unique<HostBuffer>(gpu_, uint64_t{4} * extent_.width * extent_.height);
  VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  const auto change = [&](VkImageLayout from, VkImageLayout to, VkAccessFlags written, VkAccessFlags used,
                          VkPipelineStageFlags stages, VkPipelineStageFlags after) {
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcAccessMask = written;
    barrier.dstAccessMask = used;
    vkCmdPipelineBarrier(commands_, stages, after, 0, 0, nullptr, 0, nullptr, 1, &barrier);
  };
  change(VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
         VK_ACCESS_TRANSFER_READ_BIT, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
         VK_PIPELINE_STAGE_TRANSFER_BIT);
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {extent_.width, extent_.height, 1};
  vkCmdCopyImageToBuffer(commands_, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, capture_->buffer(), 1, &copy);
  change(VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_ACCESS_TRANSFER_READ_BIT, 0,
         VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT);
}

void Swapchain::keepScreenshot() {
  capturing_ = false;
  wait();
  const std::span<const std::byte> bytes = capture_->bytes();
  const bool blueFirst = format_.format == VK_FORMAT_B8G8R8A8_UNORM;
  screenshot_ = {extent_.width, extent_.height, std::vector<uint8_t>(size_t{3} * extent_.width * extent_.height)};
  for (size_t p = 0; p < screenshot_.pixels.size() / 3; ++p)
    for (size_t c = 0; c < 3; ++c)
      screenshot_.pixels[3 * p + c] = std::to_integer<uint8_t>(bytes[4 * p + (blueFirst ? 2 - c : c)]);
  capture_.reset();
}

void Swapchain::submit(const Image& image) {
  constexpr VkPipelineStageFlags kWaiting = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
  VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  info.waitSemaphoreCount = 1;
  info.pWaitSemaphores = &acquired_;
  info.pWaitDstStageMask = &kWaiting;
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands_;
  info.signalSemaphoreCount = 1;
  info.pSignalSemaphores = &image.drawn;
  checkVulkan(vkResetFences(gpu_.device, 1, &finished_), "vkResetFences");
  gpu_.submit(info, finished_);
}

void Swapchain::present(uint32_t index) {
  VkPresentInfoKHR info{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
  info.waitSemaphoreCount = 1;
  info.pWaitSemaphores = &images_[index].drawn;
  info.swapchainCount = 1;
  info.pSwapchains = &swapchain_;
  info.pImageIndices = &index;
  VkResult result = VK_SUCCESS;
  {
    const std::lock_guard lock(gpu_.queueAccess);
    result = vkQueuePresentKHR(gpu_.queue, &info);
  }
  if (result == VK_SUBOPTIMAL_KHR || lost(result))
    stale_ = true;  // a lost surface is found out when the next image is acquired
  else
    checkVulkan(result, "vkQueuePresentKHR");
}

}  // namespace xrds
