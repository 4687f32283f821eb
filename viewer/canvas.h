#pragma once

#include "viewer/pictures.h"
#include "viewer/view_state.h"

namespace xrds {

/// Draws pictures where they lie in device memory, with the exposure and curve of a view. Used by one thread.
class Canvas {
 public:
  /// Throws Error if Vulkan fails. All must outlive the canvas.
  Canvas(Gpu& gpu, Pictures& pictures, VkRenderPass renderPass);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Records the drawing into the area from the top left corner, `width` x `height` display pixels; nothing without an
  /// input. Call it under Pictures::hold(), when what was drawn before is finished.
  void draw(VkCommandBuffer commands, const ViewState& state, uint32_t width, uint32_t height);

  /// Which picture a view takes, and which of its channels; the output's place in the frame is what the reference and
  /// the error are measured by.
  struct Choice {
    Slot slot = Slot::output;
    uint32_t kind = shader::kKindRadiance, channel = 0;
  };
  static Choice choiceOf(View view);
  /// What is drawn for a view now: itself, or the input where its picture is not there (yet).
  View shownFor(View view) const;

 private:
  void makePipeline(VkRenderPass renderPass);
  void describe(const PictureView& left, const PictureView& right);

  Gpu::Handles& gpu_;
  Pictures& pictures_;
  VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace xrds
