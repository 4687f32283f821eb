#include "viewer/vulkan/kernel.h"

namespace xrds {
namespace {

constexpr uint32_t kStorageCount = 2;

}  // namespace

VkBufferView makeTexelView(VulkanDevice& device, const DeviceBuffer& buffer, VkFormat format) {
  VkBufferViewCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
  info.buffer = buffer.buffer();
  info.format = format;
  info.range = buffer.byteSize();
  VkBufferView view = VK_NULL_HANDLE;
  checkVulkan(vkCreateBufferView(device.device, &info, nullptr, &view), "vkCreateBufferView");
  return view;
}

VkShaderModule makeModule(VulkanDevice& device, std::span<const uint32_t> program) {
  VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  info.codeSize = program.size_bytes();
  info.pCode = program.data();
  VkShaderModule module = VK_NULL_HANDLE;
  checkVulkan(vkCreateShaderModule(device.device, &info, nullptr, &module), "vkCreateShaderModule");
  return module;
}

Kernel::Kernel(VulkanDevice& device, std::span<const uint32_t> program, std::span<const Texels> texels,
               const DeviceBuffer& first, const DeviceBuffer& second, uint64_t partBytes, uint32_t pushBytes)
    : device_(device) {
  try {
    makeLayout(static_cast<uint32_t>(texels.size()), pushBytes);
    makePipeline(program);
    makeSet(texels, first, second, partBytes);
  } catch (...) {
    release();
    throw;
  }
}

Kernel::~Kernel() { release(); }

void Kernel::release() {
  for (const VkBufferView view : views_) vkDestroyBufferView(device_.device, view, nullptr);
  vkDestroyDescriptorPool(device_.device, pool_, nullptr);
  vkDestroyPipeline(device_.device, pipeline_, nullptr);
  vkDestroyPipelineLayout(device_.device, layout_, nullptr);
  vkDestroyDescriptorSetLayout(device_.device, setLayout_, nullptr);
}

void Kernel::makeLayout(uint32_t texelCount, uint32_t pushBytes) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (uint32_t i = 0; i < texelCount + kStorageCount; ++i)
    bindings.push_back(
        {i, i < texelCount ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER_DYNAMIC, 1,
         VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set.bindingCount = static_cast<uint32_t>(bindings.size());
  set.pBindings = bindings.data();
  checkVulkan(vkCreateDescriptorSetLayout(device_.device, &set, nullptr, &setLayout_), "vkCreateDescriptorSetLayout");
  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, pushBytes};
  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &setLayout_;
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &range;
  checkVulkan(vkCreatePipelineLayout(device_.device, &layout, nullptr, &layout_), "vkCreatePipelineLayout");
}

void Kernel::makePipeline(std::span<const uint32_t> program) {
  VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = makeModule(device_, program);
  info.stage.pName = "main";
  info.layout = layout_;
  const VkResult made = vkCreateComputePipelines(device_.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline_);
  vkDestroyShaderModule(device_.device, info.stage.module, nullptr);
  checkVulkan(made, "vkCreateComputePipelines");
}

void Kernel::makeSet(std::span<const Texels> texels, const DeviceBuffer& first, const DeviceBuffer& second,
                     uint64_t partBytes) {
  const auto texelCount = static_cast<uint32_t>(texels.size());
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, texelCount},
                                        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER_DYNAMIC, kStorageCount}};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = 1;
  pool.poolSizeCount = 2;
  pool.pPoolSizes = sizes;
  checkVulkan(vkCreateDescriptorPool(device_.device, &pool, nullptr, &pool_), "vkCreateDescriptorPool");
  VkDescriptorSetAllocateInfo allocation{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocation.descriptorPool = pool_;
  allocation.descriptorSetCount = 1;
  allocation.pSetLayouts = &setLayout_;
  checkVulkan(vkAllocateDescriptorSets(device_.device, &allocation, &set_), "vkAllocateDescriptorSets");
  for (const Texels& each : texels) views_.push_back(makeTexelView(device_, *each.buffer, each.format));
  const VkDescriptorBufferInfo storage[kStorageCount] = {{first.buffer(), 0, partBytes},
                                                         {second.buffer(), 0, partBytes}};
  VkWriteDescriptorSet writes[2]{{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET}, {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET}};
  writes[0].dstSet = writes[1].dstSet = set_;
  writes[0].descriptorCount = texelCount;  // runs on over the following bindings
  writes[0].descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
  writes[0].pTexelBufferView = views_.data();
  writes[1].dstBinding = texelCount;
  writes[1].descriptorCount = kStorageCount;
  writes[1].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER_DYNAMIC;
  writes[1].pBufferInfo = storage;
  vkUpdateDescriptorSets(device_.device, 2, writes, 0, nullptr);
}

void Kernel::run(std::span<const std::byte> push, uint32_t byteOffset, uint32_t columns, uint32_t rows) {
  const uint32_t offsets[kStorageCount] = {byteOffset, byteOffset};
  device_.runOnce([&](VkCommandBuffer commands) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &set_, kStorageCount, offsets);
    vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, static_cast<uint32_t>(push.size()),
                       push.data());
    vkCmdDispatch(commands, columns, rows, 1);
  });
}

}  // namespace xrds
