#include "viewer/display/canvas.h"

#include <algorithm>
#include <utility>

#include "canvas_frag.h"
#include "canvas_vert.h"
#include "image/compose.h"
#include "viewer/vulkan/kernel.h"

namespace xrds {

Image heatRamp(int steps) {
  Image ramp(steps, 1, 1);
  for (int x = 0; x < steps; ++x) ramp.at(x, 0, 0) = static_cast<float>(x) / static_cast<float>(steps - 1);
  return heatMap(ramp, 1);
}

namespace {

constexpr uint32_t kBindings = 3;

// The colours of the heat map from least to most, as a picture of one row.
std::vector<float> heatColours() {
  constexpr int kSteps = 256;
  const Image colours = heatRamp(kSteps);
  std::vector<float> pixels;
  for (int x = 0; x < kSteps; ++x)
    pixels.insert(pixels.end(), {colours.at(x, 0, 0), colours.at(x, 0, 1), colours.at(x, 0, 2), 0});
  return pixels;
}

// The pixels of the display whose middle lies in [begin, end), as far as they are in [0, limit).
std::pair<uint32_t, uint32_t> pixelsOf(double begin, double end, double limit) {
  const auto first = [&](double edge) { return static_cast<uint32_t>(std::clamp(std::ceil(edge - 0.5), 0.0, limit)); };
  return {first(begin), first(end)};
}

}  // namespace

Canvas::Canvas(VulkanDevice& gpu, Pictures& pictures, VkRenderPass renderPass) : gpu_(gpu), pictures_(pictures) {
  pictures.upload(Slot::heat, 256, 1, 1, heatColours());
  VkDescriptorSetLayoutBinding bindings[kBindings]{};
  for (uint32_t i = 0; i < kBindings; ++i)
    bindings[i] = {i, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr};
  VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set.bindingCount = kBindings;
  set.pBindings = bindings;
  checkVulkan(vkCreateDescriptorSetLayout(gpu_.device, &set, nullptr, &setLayout_), "vkCreateDescriptorSetLayout");
  const VkPushConstantRange range{VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(shader::PictureParameters)};
  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &setLayout_;
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &range;
  checkVulkan(vkCreatePipelineLayout(gpu_.device, &layout, nullptr, &layout_), "vkCreatePipelineLayout");
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, kBindings * 3};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = 3;
  pool.poolSizeCount = 1;
  pool.pPoolSizes = &size;
  checkVulkan(vkCreateDescriptorPool(gpu_.device, &pool, nullptr, &pool_), "vkCreateDescriptorPool");
  VkDescriptorSetAllocateInfo allocation{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocation.descriptorPool = pool_;
  const VkDescriptorSetLayout layouts[] = {setLayout_, setLayout_, setLayout_};
  allocation.descriptorSetCount = 3;
  allocation.pSetLayouts = layouts;
  checkVulkan(vkAllocateDescriptorSets(gpu_.device, &allocation, sets_.data()), "vkAllocateDescriptorSets");
  makePipelines(renderPass);
}

Canvas::~Canvas() {
  for (const VkPipeline pipeline : pipelines_) vkDestroyPipeline(gpu_.device, pipeline, nullptr);
  vkDestroyDescriptorPool(gpu_.device, pool_, nullptr);
  vkDestroyPipelineLayout(gpu_.device, layout_, nullptr);
  vkDestroyDescriptorSetLayout(gpu_.device, setLayout_, nullptr);
}

void Canvas::makePipelines(VkRenderPass renderPass) {
  VkPipelineShaderStageCreateInfo stages[2]{};
  for (VkPipelineShaderStageCreateInfo& stage : stages) {
    stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    stage.pName = "main";
  }
  stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
  stages[0].module = makeModule(gpu_, canvas_vert);
  stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
  stages[1].module = makeModule(gpu_, canvas_frag);
  const VkPipelineVertexInputStateCreateInfo vertices{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.lineWidth = 1;
  VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  VkPipelineColorBlendAttachmentState attachment{};
  attachment.colorWriteMask = 0xf;
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = 1;
  blend.pAttachments = &attachment;
  const VkDynamicState dynamic[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo changing{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  changing.dynamicStateCount = 2;
  changing.pDynamicStates = dynamic;
  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  info.stageCount = 2;
  info.pStages = stages;
  info.pVertexInputState = &vertices;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pColorBlendState = &blend;
  info.pDynamicState = &changing;
  info.layout = layout_;
  info.renderPass = renderPass;
  constexpr VkSpecializationMapEntry kEntry{0, 0, sizeof(uint32_t)};
  VkResult made = VK_SUCCESS;
  for (uint32_t kind = 0; kind < shader::kKindCount && made == VK_SUCCESS; ++kind) {
    const VkSpecializationInfo specialization{1, &kEntry, sizeof kind, &kind};
    stages[1].pSpecializationInfo = &specialization;
    made = vkCreateGraphicsPipelines(gpu_.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipelines_[kind]);
  }
  for (const auto& stage : stages) vkDestroyShaderModule(gpu_.device, stage.module, nullptr);
  checkVulkan(made, "vkCreateGraphicsPipelines");
}

Canvas::Choice Canvas::choiceOf(View view) {
  switch (view) {
    case View::input:
      return {Slot::input};
    case View::bicubic:
      return {Slot::bicubic};
    case View::demodulated:
      return {Slot::demodulated};
    case View::guided:
      return {Slot::guided};
    case View::reference:
      return {Slot::reference};
    case View::error:
      return {Slot::output, shader::kKindError, Slot::reference};
    case View::albedo:
      return {Slot::auxiliary, shader::kKindAlbedo};
    case View::normal:
      return {Slot::auxiliary, shader::kKindNormal};
    case View::skip:
      return {Slot::output, shader::kKindSkip, Slot::skipMap};
    case View::denoised:
      return {Slot::denoised};
    case View::flicker:
      return {Slot::flicker, shader::kKindFlicker};
    case View::output:
      break;
  }
  return {Slot::output};
}

View Canvas::shownFor(View view) const {
  const Choice choice = choiceOf(view);
  const PictureView picture = pictures_.at(choice.slot);
  const bool missing = !picture.valid || picture.planes <= choice.plane() || !pictures_.at(choice.other).valid;
  if (!missing) return view;
  return view == View::output && pictures_.at(Slot::guided).valid ? View::guided : View::input;
}

void Canvas::describe(VkDescriptorSet set, const Choice& choice) {
  const VkBufferView views[kBindings] = {pictures_.at(choice.slot).texels, pictures_.at(choice.other).texels,
                                         pictures_.at(Slot::heat).texels};
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstSet = set;
  write.descriptorCount = kBindings;  // runs on over the following bindings
  write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
  write.pTexelBufferView = views;
  vkUpdateDescriptorSets(gpu_.device, 1, &write, 0, nullptr);
}

void Canvas::draw(VkCommandBuffer commands, const ViewState& state, uint32_t width, uint32_t height) {
  if (width == 0) return;
  if (!std::exchange(isWarm_, true)) warmUp(commands);
  if (!pictures_.at(Slot::input).valid) return;
  const Viewport& viewport = state.viewport;
  const double left = viewport.left, right = left + viewport.zoom * viewport.pictureWidth;
  const double divider = state.wiping ? std::clamp(std::round(state.divider()), left, right) : left;
  const auto rows = pixelsOf(viewport.top, viewport.top + viewport.zoom * viewport.pictureHeight, height);
  const auto part = [&](double begin, double end) {
    const auto columns = pixelsOf(begin, end, width);
    return VkRect2D{{static_cast<int32_t>(columns.first), static_cast<int32_t>(rows.first)},
                    {columns.second - columns.first, rows.second - rows.first}};
  };
  drawPart(commands, sets_[0], choiceOf(shownFor(state.left)), state, part(left, divider));
  drawPart(commands, sets_[1], choiceOf(shownFor(state.right)), state, part(divider, right));
}

// CPU devices compile a pipeline when it first draws: one pixel with each, before anybody waits for a new view.
void Canvas::warmUp(VkCommandBuffer commands) {
  const VkRect2D pixel{{}, {1, 1}};
  shader::PictureParameters parameters{};
  parameters.picture = {1, 1, 1};
  parameters.width = parameters.height = parameters.windowSide = 1;
  parameters.zoom = 1;
  describe(sets_[2], {Slot::heat});
  vkCmdSetScissor(commands, 0, 1, &pixel);
  for (uint32_t kind = 0; kind < shader::kKindCount; ++kind) record(commands, sets_[2], kind, parameters);
}

void Canvas::drawPart(VkCommandBuffer commands, VkDescriptorSet set, const Choice& choice, const ViewState& state,
                      const VkRect2D& part) {
  if (part.extent.width == 0 || part.extent.height == 0) return;
  describe(set, choice);
  const PictureView picture = pictures_.at(choice.slot);
  const Viewport& viewport = state.viewport;
  shader::PictureParameters parameters{};
  parameters.picture = {picture.width, picture.height, picture.planes};
  parameters.width = static_cast<uint32_t>(viewport.pictureWidth);
  parameters.height = static_cast<uint32_t>(viewport.pictureHeight);
  parameters.originX = static_cast<float>(viewport.left);
  parameters.originY = static_cast<float>(viewport.top);
  parameters.zoom = static_cast<float>(viewport.zoom);
  parameters.exposure = state.exposure();
  parameters.curve = state.curve;
  parameters.windowSide = std::max(state.windowSide, 1U);
  vkCmdSetScissor(commands, 0, 1, &part);
  record(commands, set, choice.kind, parameters);
}

void Canvas::record(VkCommandBuffer commands, VkDescriptorSet set, uint32_t kind,
                    const shader::PictureParameters& parameters) {
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_[kind]);
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_, 0, 1, &set, 0, nullptr);
  vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof parameters, &parameters);
  vkCmdDraw(commands, 3, 1, 0, 0);
}

}  // namespace xrds
