/* A renderer with a Vulkan device of its own: path-traces a scene at low resolution, and its albedo and normals at full
 * resolution, into buffers; xrds upscales them in the same command buffer. Nothing passes the host but the result:
 *
 *     embed_vulkan RESULT.pfm [MODEL [WIDTH HEIGHT [FRAMES]]]
 *
 * Two frames are in flight. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <vulkan/vulkan.h>
#include <xrds/xrds_vulkan.h>

#include "trace.h"

enum { kInFlight = 2, kGuides = 2, kBuffers = 4 };

typedef struct Push {
  uint32_t width, height, samples, seed, what;
} Push;

typedef struct Buffer {
  VkBuffer buffer;
  VkDeviceMemory memory;
  uint32_t width, height;
} Buffer;

/* Colour, albedo, normal and result. */
typedef struct Frame {
  Buffer buffers[kBuffers];
  VkDescriptorSet sets[kBuffers];
  VkCommandBuffer commands;
  VkFence fence;
  XrdsRecording* recording;
} Frame;

static VkInstance instance;
static VkPhysicalDevice physicalDevice;
static VkDevice device;
static VkQueue queue;
static uint32_t family;
static VkCommandPool commandPool;
static VkPipelineLayout layout;
static VkPipeline pipeline;
static VkDescriptorSetLayout setLayout;
static VkDescriptorPool descriptorPool;
static XrdsVulkanFeatures features = {.structSize = sizeof features};

static void vulkan(VkResult result, const char* call) {
  if (result == VK_SUCCESS) return;
  fprintf(stderr, "%s failed: %d\n", call, result);
  exit(1);
}
#define VULKAN(call) vulkan(call, #call)

static void xrds(XrdsResult result) {
  if (result == XRDS_OK) return;
  fprintf(stderr, "%s\n", xrdsGetMessage());
  exit(1);
}

/* What xrds asks for is enabled like anything else that the renderer needs itself. */
static void openDevice(void) {
  const VkApplicationInfo application = {VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_2};
  const VkInstanceCreateInfo info = {VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application};
  VULKAN(vkCreateInstance(&info, NULL, &instance));
  uint32_t count = 1;
  vkEnumeratePhysicalDevices(instance, &count, &physicalDevice);
  if (count == 0) exit(fprintf(stderr, "There is no Vulkan device\n"));
  VkQueueFamilyProperties families[16];
  count = 16;
  vkGetPhysicalDeviceQueueFamilyProperties(physicalDevice, &count, families);
  while (family < count && !(families[family].queueFlags & VK_QUEUE_COMPUTE_BIT)) ++family;

  xrds(xrdsGetVulkanFeatures(vkGetInstanceProcAddr, instance, physicalDevice, &features));
  /* This program knows no cooperative matrices: what is not enabled, xrds does without. */
  features.cooperativeMatrixKhr = features.cooperativeMatrixNv = 0;
  VkPhysicalDeviceVulkan12Features features12 = {
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
      .shaderSubgroupExtendedTypes = (VkBool32)features.shaderSubgroupExtendedTypes};
  const VkPhysicalDeviceFeatures2 enabled = {
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12, {.shaderInt64 = (VkBool32)features.shaderInt64}};
  const float priority = 1;
  const VkDeviceQueueCreateInfo queues = {VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueFamilyIndex = family,
                                          .queueCount = 1, .pQueuePriorities = &priority};
  const VkDeviceCreateInfo create = {VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &enabled, .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queues};
  VULKAN(vkCreateDevice(physicalDevice, &create, NULL, &device));
  vkGetDeviceQueue(device, family, 0, &queue);
  const VkCommandPoolCreateInfo pool = {VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                        .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                        .queueFamilyIndex = family};
  VULKAN(vkCreateCommandPool(device, &pool, NULL, &commandPool));
}

static void makeTracer(void) {
  const VkDescriptorSetLayoutBinding binding = {0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT,
                                                NULL};
  const VkDescriptorSetLayoutCreateInfo sets = {VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = 1,
                                                .pBindings = &binding};
  VULKAN(vkCreateDescriptorSetLayout(device, &sets, NULL, &setLayout));
  const VkPushConstantRange push = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(Push)};
  const VkPipelineLayoutCreateInfo layouts = {VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, .setLayoutCount = 1,
                                              .pSetLayouts = &setLayout, .pushConstantRangeCount = 1,
                                              .pPushConstantRanges = &push};
  VULKAN(vkCreatePipelineLayout(device, &layouts, NULL, &layout));
  const VkShaderModuleCreateInfo code = {VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = sizeof trace,
                                         .pCode = trace};
  VkShaderModule module;
  VULKAN(vkCreateShaderModule(device, &code, NULL, &module));
  const VkComputePipelineCreateInfo info = {
      VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
      .stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                .module = module, .pName = "main"},
      .layout = layout};
  VULKAN(vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &info, NULL, &pipeline));
  vkDestroyShaderModule(device, module, NULL);
  const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kInFlight * kBuffers};
  const VkDescriptorPoolCreateInfo pool = {VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                           .maxSets = kInFlight * kBuffers, .poolSizeCount = 1, .pPoolSizes = &size};
  VULKAN(vkCreateDescriptorPool(device, &pool, NULL, &descriptorPool));
}

/* Three floats a pixel. The result is where the host sees it, as this program saves it. */
static Buffer makeBuffer(uint32_t width, uint32_t height, VkMemoryPropertyFlags wanted) {
  Buffer made = {.width = width, .height = height};
  const VkBufferCreateInfo info = {VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = (VkDeviceSize)12 * width * height,
                                   .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
  VULKAN(vkCreateBuffer(device, &info, NULL, &made.buffer));
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device, made.buffer, &needs);
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(physicalDevice, &memory);
  uint32_t type = 0;
  while (!(needs.memoryTypeBits >> type & 1) || (memory.memoryTypes[type].propertyFlags & wanted) != wanted) ++type;
  const VkMemoryAllocateInfo allocation = {VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size,
                                           .memoryTypeIndex = type};
  VULKAN(vkAllocateMemory(device, &allocation, NULL, &made.memory));
  VULKAN(vkBindBufferMemory(device, made.buffer, made.memory, 0));
  return made;
}

static void makeFrame(Frame* frame, XrdsUpscaler* upscaler, uint32_t width, uint32_t height, uint32_t scale) {
  const VkMemoryPropertyFlags local = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                              seen = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  XrdsVulkanImage images[kBuffers];
  for (int i = 0; i < kBuffers; ++i) {
    const uint32_t s = i == 0 ? 1 : scale;
    Buffer* buffer = &frame->buffers[i];
    *buffer = makeBuffer(s * width, s * height, i + 1 < kBuffers ? local : seen);
    images[i] = xrdsBufferImage(buffer->buffer, XRDS_FLOAT, 3, buffer->width, buffer->height);
    const VkDescriptorSetAllocateInfo sets = {VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                              .descriptorPool = descriptorPool, .descriptorSetCount = 1,
                                              .pSetLayouts = &setLayout};
    VULKAN(vkAllocateDescriptorSets(device, &sets, &frame->sets[i]));
    const VkDescriptorBufferInfo range = {buffer->buffer, 0, VK_WHOLE_SIZE};
    const VkWriteDescriptorSet write = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, .dstSet = frame->sets[i],
                                        .descriptorCount = 1, .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                        .pBufferInfo = &range};
    vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
  }
  XrdsVulkanFrame described = xrdsVulkanFrameDefault();
  described.colour = images[0];
  described.auxiliary = &images[1];
  described.auxiliaryCount = kGuides;
  described.output = images[3];
  xrds(xrdsCreateRecording(upscaler, &described, &frame->recording));
  const VkCommandBufferAllocateInfo commands = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                .commandPool = commandPool, .commandBufferCount = 1};
  VULKAN(vkAllocateCommandBuffers(device, &commands, &frame->commands));
  const VkFenceCreateInfo fence = {VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .flags = VK_FENCE_CREATE_SIGNALED_BIT};
  VULKAN(vkCreateFence(device, &fence, NULL, &frame->fence));
}

static double microseconds(void) {
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return 1e6 * (double)now.tv_sec + 1e-3 * (double)now.tv_nsec;
}

/* The renderer's own work, then xrds; gives the time that recording the latter takes. */
static double recordAndSubmit(Frame* frame, uint32_t number) {
  VULKAN(vkWaitForFences(device, 1, &frame->fence, VK_TRUE, UINT64_MAX));
  VULKAN(vkResetFences(device, 1, &frame->fence));
  const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  VULKAN(vkBeginCommandBuffer(frame->commands, &begin));
  vkCmdBindPipeline(frame->commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
  for (uint32_t i = 0; i < 1 + kGuides; ++i) {
    const Push push = {frame->buffers[i].width, frame->buffers[i].height, 16, number, i};
    vkCmdBindDescriptorSets(frame->commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, &frame->sets[i], 0, NULL);
    vkCmdPushConstants(frame->commands, layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
    vkCmdDispatch(frame->commands, (push.width + 7) / 8, (push.height + 7) / 8, 1);
  }
  const double start = microseconds();
  xrds(xrdsRecord(frame->recording, frame->commands)); /* its own barriers are around it */
  const double taken = microseconds() - start;
  VULKAN(vkEndCommandBuffer(frame->commands));
  const VkSubmitInfo submit = {VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1,
                               .pCommandBuffers = &frame->commands};
  VULKAN(vkQueueSubmit(queue, 1, &submit, frame->fence));
  return taken;
}

/* Rows from the bottom, as the format has them. */
static void save(const char* path, const Buffer* result) {
  void* mapped;
  VULKAN(vkMapMemory(device, result->memory, 0, VK_WHOLE_SIZE, 0, &mapped));
  FILE* file = fopen(path, "wb");
  if (!file || fprintf(file, "PF\n%u %u\n-1\n", result->width, result->height) < 0) exit((perror(path), 1));
  for (uint32_t y = result->height; y-- > 0;)
    fwrite((float*)mapped + (size_t)3 * result->width * y, 12, result->width, file);
  if (fclose(file) != 0) exit((perror(path), 1));
  vkUnmapMemory(device, result->memory);
}

static void destroyFrame(Frame* frame) {
  xrdsDestroyRecording(frame->recording);
  for (int i = 0; i < kBuffers; ++i) {
    vkDestroyBuffer(device, frame->buffers[i].buffer, NULL);
    vkFreeMemory(device, frame->buffers[i].memory, NULL);
  }
  vkDestroyFence(device, frame->fence, NULL);
}

static void closeDevice(void) {
  vkDestroyDescriptorPool(device, descriptorPool, NULL);
  vkDestroyPipeline(device, pipeline, NULL);
  vkDestroyPipelineLayout(device, layout, NULL);
  vkDestroyDescriptorSetLayout(device, setLayout, NULL);
  vkDestroyCommandPool(device, commandPool, NULL);
  vkDestroyDevice(device, NULL);
  vkDestroyInstance(instance, NULL);
}

int main(int count, char** arguments) {
  if (count < 2) return fprintf(stderr, "usage: %s RESULT.pfm [MODEL [WIDTH HEIGHT [FRAMES]]]\n", arguments[0]), 2;
  const char* model = count > 2 ? arguments[2] : "xrds-x4-nano";
  const uint32_t width = count > 4 ? (uint32_t)atoi(arguments[3]) : 96,
                 height = count > 4 ? (uint32_t)atoi(arguments[4]) : 64;
  const uint32_t frameCount = count > 5 ? (uint32_t)atoi(arguments[5]) : 3;
  openDevice();
  makeTracer();
  const XrdsVulkanDevice mine = {.structSize = sizeof mine,
                                 .queueFamily = family,
                                 .loader = vkGetInstanceProcAddr,
                                 .instance = instance,
                                 .physicalDevice = physicalDevice,
                                 .device = device,
                                 .queue = queue,
                                 .enabled = &features};
  XrdsDevice* shared;
  XrdsModel* network;
  XrdsUpscaler* upscaler;
  xrds(xrdsOpenVulkanDevice(&mine, NULL, &shared));
  xrds(xrdsOpenModel(model, &network));
  xrds(xrdsCreateUpscaler(shared, network, width, height, NULL, &upscaler));
  Frame frames[kInFlight] = {0};
  for (int i = 0; i < kInFlight; ++i) makeFrame(&frames[i], upscaler, width, height, xrdsGetModelScale(network));
  for (uint32_t i = 0; i < frameCount; ++i)
    printf("frame %u: xrdsRecord took %.1f us\n", i, recordAndSubmit(&frames[i % kInFlight], i));
  VULKAN(vkDeviceWaitIdle(device));
  save(arguments[1], &frames[(frameCount + kInFlight - 1) % kInFlight].buffers[kBuffers - 1]);
  for (int i = 0; i < kInFlight; ++i) destroyFrame(&frames[i]);
  xrdsDestroyUpscaler(upscaler);
  xrdsCloseModel(network);
  xrdsCloseDevice(shared);
  closeDevice();
  return 0;
}
