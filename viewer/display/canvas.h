#pragma once

#include "image/image.h"
#include "viewer/pictures.h"
#include "viewer/view_state.h"

namespace xrds {

/// The colours of the heat map in so many steps from least to most, linear, as an image of one row.
Image heatRamp(int steps);

/// Draws pictures where they lie in device memory, with the exposure and curve of a view. Used by one thread.
class Canvas {
 public:
  /// Throws Error if Vulkan fails. All must outlive the canvas.
  Canvas(VulkanDevice& gpu, Pictures& pictures, VkRenderPass renderPass);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Records the drawing into the area from the top left corner, `width` x `height` display pixels; nothing without an
  /// input. Call it under Pictures::hold(), when what was drawn before is finished.
  void draw(VkCommandBuffer commands, const ViewState& state, uint32_t width, uint32_t height);

  /// Which picture a view takes, as what, and which other one it needs beside it.
  struct Choice {
    Slot slot = Slot::output;
    uint32_t kind = shader::kKindRadiance;
    Slot other = Slot::heat;                                                // which is always there
    uint32_t plane() const { return kind == shader::kKindNormal ? 1 : 0; }  // that is shown
  };
  static Choice choiceOf(View view);
  /// What is drawn for a view now: itself, or where its picture is not there (yet), the guided image or the input.
  View shownFor(View view) const;

 private:
  void makePipelines(VkRenderPass renderPass);
  void describe(VkDescriptorSet set, const Choice& choice);
  void drawPart(VkCommandBuffer commands, VkDescriptorSet set, const Choice& choice, const ViewState& state,
                const VkRect2D& part);
  void warmUp(VkCommandBuffer commands);
  void record(VkCommandBuffer commands, VkDescriptorSet set, uint32_t kind,
              const shader::PictureParameters& parameters);

  VulkanDevice& gpu_;
  Pictures& pictures_;
  VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  std::array<VkPipeline, shader::kKindCount> pipelines_{};  // by what they show
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  std::array<VkDescriptorSet, 3> sets_{};  // left and right of the divider; to warm up
  bool isWarm_ = false;
};

}  // namespace xrds
