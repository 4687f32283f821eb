#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/device.h"
#include "engine/dispatch.h"
#include "engine/drivers/instance.h"

namespace xrds {

/// What decides a compiled pipeline. Two dispatches with the same key share it.
struct PipelineKey {
  explicit PipelineKey(const Dispatch& dispatch);
  std::string program;
  std::vector<uint32_t> specialization;
  std::vector<std::pair<BindingKind, DataType>> bindings;  // the type, because CPU drivers compile a texel's format in
  uint32_t pushConstantBytes = 0;
  uint32_t subgroupSize = 0;
  bool fullSubgroups = false;
  bool operator<(const PipelineKey& other) const {
    const auto all = [](const PipelineKey& key) {
      return std::tie(key.program, key.specialization, key.bindings, key.pushConstantBytes, key.subgroupSize,
                      key.fullSubgroups);
    };
    return all(*this) < all(other);
  }
};

struct Pipeline {
  VkDescriptorSetLayout setLayout = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkPipeline pipeline = VK_NULL_HANDLE;
};

VkDescriptorType descriptorTypeOf(BindingKind kind);
/// Of the texels that hold four numbers of a type: as vec4, or their bits.
VkFormat texelFormatOf(DataType type, BindingKind kind);

/// One set out of the pool, which frees it.
VkDescriptorSet allocateSet(const Gpu::Handles& gpu, VkDescriptorPool pool, VkDescriptorSetLayout layout);

/// Records a dispatch of as many groups with its pipeline, which must have been made, and its push constants.
void recordDispatch(const Gpu::Handles& gpu, VkCommandBuffer commands, const Dispatch& dispatch, VkDescriptorSet set,
                    std::array<uint32_t, 3> groupCount);

/// Makes the pipelines of the keys that the device has not made yet, in parallel if there are many, and calls `made`
/// after each, in the thread that made it. Throws the failure of the first that fails, whichever thread met it, and
/// Cancelled if DeviceOptions::onPreparation says so.
void makePipelines(Gpu::Handles& gpu, std::span<const PipelineKey> keys,
                   const std::function<void(const PipelineKey&)>& made = {});

/// Destroys a pipeline, so that the next who asks for it makes it again.
void forgetPipeline(Gpu::Handles& gpu, const PipelineKey& key);

/// Makes the pipelines of dispatches and compiles their programs, where the driver would otherwise do it at the first
/// dispatch, one after the other: on CPU devices. Throws as makePipelines does.
void makeCompiledPipelines(Gpu& gpu, std::span<const Dispatch* const> dispatches);

/// Writes the pipeline cache to its file if it has grown. Failing to write is no error: it is only a cache.
void savePipelineCache(Gpu::Handles& gpu) noexcept;

}  // namespace xrds
