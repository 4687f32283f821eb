#include "bench/gpu_static/compiled.h"

#include "engine/drivers/vulkan_result.h"

namespace xrds {
namespace {

// What one of Vulkan's functions that are asked twice has to say.
template <class T, class Function, class... Arguments>
std::vector<T> listed(VkStructureType type, Function function, Arguments... arguments) {
  uint32_t count = 0;
  checkResult(function(arguments..., &count, nullptr), "a question about a pipeline");
  T empty{};
  empty.sType = type;
  std::vector<T> list(count, empty);
  checkResult(function(arguments..., &count, list.data()), "a question about a pipeline");
  return list;
}

double numberOf(const VkPipelineExecutableStatisticKHR& statistic) {
  switch (statistic.format) {
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_BOOL32_KHR:
      return statistic.value.b32;
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_INT64_KHR:
      return static_cast<double>(statistic.value.i64);
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_UINT64_KHR:
      return static_cast<double>(statistic.value.u64);
    default:
      return statistic.value.f64;
  }
}

void addTexts(Gpu::Handles& gpu, const VkPipelineExecutableInfoKHR& part, Compiled& found) {
  const auto ask = gpu.vk.vkGetPipelineExecutableInternalRepresentationsKHR;
  auto texts = listed<VkPipelineExecutableInternalRepresentationKHR>(
      VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INTERNAL_REPRESENTATION_KHR, ask, gpu.device, &part);
  std::vector<std::string> storage(texts.size());
  for (size_t i = 0; i < texts.size(); ++i) {
    storage[i].resize(texts[i].dataSize);
    texts[i].pData = storage[i].data();
  }
  auto count = static_cast<uint32_t>(texts.size());
  checkResult(ask(gpu.device, &part, &count, texts.data()), "vkGetPipelineExecutableInternalRepresentationsKHR");
  for (size_t i = 0; i < texts.size(); ++i) found.texts[texts[i].name] = storage[i].c_str();
}

}  // namespace

Compiled compiled(Gpu::Handles& gpu, const PipelineKey& key) {
  Compiled found;
  try {
    makePipelines(gpu, {&key, 1});
  } catch (const std::exception& error) {
    found.error = error.what();
    return found;
  }
  VkPipelineInfoKHR pipeline{VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR};
  pipeline.pipeline = gpu.pipelines.at(key).pipeline;
  const auto parts =
      listed<VkPipelineExecutablePropertiesKHR>(VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR,
                                                gpu.vk.vkGetPipelineExecutablePropertiesKHR, gpu.device, &pipeline);
  for (uint32_t i = 0; i < parts.size(); ++i) {
    found.subgroupSize = parts[i].subgroupSize;
    VkPipelineExecutableInfoKHR part{VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR};
    part.pipeline = pipeline.pipeline;
    part.executableIndex = i;
    for (const auto& statistic :
         listed<VkPipelineExecutableStatisticKHR>(VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR,
                                                  gpu.vk.vkGetPipelineExecutableStatisticsKHR, gpu.device, &part))
      found.statistics[statistic.name] = numberOf(statistic);
    addTexts(gpu, part, found);
  }
  forgetPipeline(gpu, key);
  return found;
}

}  // namespace xrds
