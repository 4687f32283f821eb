// Compiles programs to compute pipelines.
#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>

#include "engine/drivers/llvmpipe.h"
#include "engine/drivers/vulkan_result.h"
#include "engine/handles.h"
#include "engine/pipelines/preparation.h"
#include "engine/pipelines/shared_loads.h"
#include "engine/pipelines/visibility.h"
#include "xrds/error.h"

namespace xrds {
namespace {

VkDescriptorSetLayout makeSetLayout(const Gpu::Handles& gpu, const PipelineKey& key) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const auto& [kind, type] : key.bindings)
    bindings.push_back({.binding = static_cast<uint32_t>(bindings.size()),
                        .descriptorType = descriptorTypeOf(kind),
                        .descriptorCount = 1,
                        .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT});
  VkDescriptorSetLayoutCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  info.bindingCount = static_cast<uint32_t>(bindings.size());
  info.pBindings = bindings.data();
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  checkResult(gpu.vk.vkCreateDescriptorSetLayout(gpu.device, &info, nullptr, &layout), "vkCreateDescriptorSetLayout");
  return layout;
}

VkPipelineLayout makeLayout(const Gpu::Handles& gpu, VkDescriptorSetLayout setLayout, uint32_t pushConstantBytes) {
  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, pushConstantBytes};
  VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  info.setLayoutCount = 1;
  info.pSetLayouts = &setLayout;
  info.pushConstantRangeCount = pushConstantBytes ? 1 : 0;
  info.pPushConstantRanges = &push;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  checkResult(gpu.vk.vkCreatePipelineLayout(gpu.device, &info, nullptr, &layout), "vkCreatePipelineLayout");
  return layout;
}

VkPipeline makePipeline(const Gpu::Handles& gpu, const PipelineKey& key, VkPipelineLayout layout) {
  const auto program = gpu.options.programs ? gpu.options.programs(key.program) : std::span<const uint32_t>{};
  if (program.empty()) throw std::logic_error("There is no program \"" + key.program + "\".");
  std::vector<uint32_t> words = visibleAtBarriers(program);
  // The other families read the same place again and again.
  const bool readsOnce = key.program.find(std::string("_") + nameOf(KernelFamily::lane)) != std::string::npos;
  if (readsOnce && llvmpipeTraits(gpu.description.driver).comparesSharedLoads) words = withVolatileSharedLoads(words);
  VkShaderModuleCreateInfo moduleInfo{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  moduleInfo.codeSize = words.size() * sizeof(uint32_t);
  moduleInfo.pCode = words.data();
  VkShaderModule module = VK_NULL_HANDLE;
  checkResult(gpu.vk.vkCreateShaderModule(gpu.device, &moduleInfo, nullptr, &module), "vkCreateShaderModule");

  std::vector<VkSpecializationMapEntry> entries;
  std::vector<uint32_t> constants = key.specialization;
  constants.push_back(static_cast<uint32_t>(gpu.traits.laneCode));
  for (uint32_t id = 0; id < constants.size(); ++id) entries.push_back({id, id * 4, 4});
  entries.back().constantID = kLaneCodeConstant;
  const VkSpecializationInfo specialization{static_cast<uint32_t>(entries.size()), entries.data(), constants.size() * 4,
                                            constants.data()};
  VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  info.flags = gpu.pipelineFlags;
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialization;
  VkPipelineShaderStageRequiredSubgroupSizeCreateInfo subgroups{
      VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_REQUIRED_SUBGROUP_SIZE_CREATE_INFO};
  subgroups.requiredSubgroupSize = key.subgroupSize;
  if (key.subgroupSize > 0 && gpu.choosesSubgroups) info.stage.pNext = &subgroups;
  if (key.fullSubgroups) info.stage.flags = VK_PIPELINE_SHADER_STAGE_CREATE_REQUIRE_FULL_SUBGROUPS_BIT;
  info.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  const VkResult result = gpu.vk.vkCreateComputePipelines(gpu.device, gpu.pipelineCache, 1, &info, nullptr, &pipeline);
  gpu.vk.vkDestroyShaderModule(gpu.device, module, nullptr);
  checkResult(result, ("vkCreateComputePipelines for " + key.program).c_str());
  return pipeline;
}

// The members are filled as they are made, so that the owner destroys them if a later step throws.
void compile(const Gpu::Handles& gpu, const PipelineKey& key, Pipeline& made) {
  made.setLayout = makeSetLayout(gpu, key);
  made.layout = makeLayout(gpu, made.setLayout, key.pushConstantBytes);
  made.pipeline = makePipeline(gpu, key, made.layout);
}

}  // namespace

void forgetPipeline(Gpu::Handles& gpu, const PipelineKey& key) {
  const auto place = gpu.pipelines.find(key);
  const Pipeline& made = place->second;
  gpu.vk.vkDestroyPipeline(gpu.device, made.pipeline, nullptr);
  gpu.vk.vkDestroyPipelineLayout(gpu.device, made.layout, nullptr);
  gpu.vk.vkDestroyDescriptorSetLayout(gpu.device, made.setLayout, nullptr);
  gpu.pipelines.erase(place);
}

PipelineKey::PipelineKey(const Dispatch& dispatch)
    : program(dispatch.program),
      specialization(dispatch.specialization),
      pushConstantBytes(static_cast<uint32_t>(dispatch.pushConstants.size())),
      subgroupSize(dispatch.subgroupSize),
      fullSubgroups(dispatch.fullSubgroups) {
  for (const Binding& binding : dispatch.bindings) bindings.emplace_back(binding.kind, binding.type);
}

VkDescriptorType descriptorTypeOf(BindingKind kind) {
  return isTexelBuffer(kind) ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

VkFormat texelFormatOf(DataType type, BindingKind kind) {
  if (kind == BindingKind::texelBits)
    return type == DataType::f32 ? VK_FORMAT_R32G32B32A32_UINT : VK_FORMAT_R32G32_UINT;
  return type == DataType::f32 ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_R16G16B16A16_SFLOAT;
}

VkDescriptorSet allocateSet(const Gpu::Handles& gpu, VkDescriptorPool pool, VkDescriptorSetLayout layout) {
  VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  info.descriptorPool = pool;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  checkResult(gpu.vk.vkAllocateDescriptorSets(gpu.device, &info, &set), "vkAllocateDescriptorSets");
  return set;
}

void recordDispatch(const Gpu::Handles& gpu, VkCommandBuffer commands, const Dispatch& dispatch, VkDescriptorSet set,
                    std::array<uint32_t, 3> groupCount) {
  const Pipeline& made = gpu.pipelines.at(PipelineKey(dispatch));
  gpu.vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, made.pipeline);
  gpu.vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, made.layout, 0, 1, &set, 0, nullptr);
  if (!dispatch.pushConstants.empty())
    gpu.vk.vkCmdPushConstants(commands, made.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                              static_cast<uint32_t>(dispatch.pushConstants.size()), dispatch.pushConstants.data());
  gpu.vk.vkCmdDispatch(commands, groupCount[0], groupCount[1], groupCount[2]);
}

void makePipelines(Gpu::Handles& gpu, std::span<const PipelineKey> keys,
                   const std::function<void(const PipelineKey&)>& made) {
  std::vector<std::pair<const PipelineKey, Pipeline>*> missing;
  for (const PipelineKey& key : keys)
    if (const auto [place, isNew] = gpu.pipelines.try_emplace(key); isNew) missing.push_back(&*place);

  constexpr size_t kFew = 4;
  const size_t threadCount =
      missing.size() <= kFew ? 1 : std::clamp<size_t>(std::thread::hardware_concurrency(), 1, missing.size());
  std::atomic<size_t> next = 0;
  std::vector<std::exception_ptr> failures(missing.size());
  PreparationReport report(gpu.options.onPreparation, Preparation::Phase::pipelines, missing.size());
  const auto work = [&](size_t) {
    for (size_t i = next++; i < missing.size() && !report.cancelled(); i = next++) {
      try {
        compile(gpu, missing[i]->first, missing[i]->second);
        if (made) made(missing[i]->first);
      } catch (...) {
        failures[i] = std::current_exception();
      }
      report.advance();
    }
  };
  std::exception_ptr first;
  try {
    if (!missing.empty()) report.await(threadCount, work);
  } catch (const Cancelled&) {
    for (const auto* each : missing) forgetPipeline(gpu, each->first);
    throw;
  }
  for (size_t i = 0; i < missing.size(); ++i) {
    if (!failures[i]) continue;
    if (!first) first = failures[i];
    forgetPipeline(gpu, missing[i]->first);
  }
  if (first) std::rethrow_exception(first);
}

}  // namespace xrds
