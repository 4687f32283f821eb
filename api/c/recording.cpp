// Frames of an upscaler in command buffers and on a queue of the caller's.
#include <list>

#include "api/arguments.h"
#include "api/c/handles.h"
#include "api/c/result.h"
#include "api/c/sized.h"
#include "engine/host_device.h"
#include "engine/host_recording.h"
#include "frames/host_frame.h"
#include "xrds/engine_access.h"
#include "xrds/xrds_vulkan.h"

using namespace xrds::c;

struct XrdsRecording {
  XrdsRecording(std::shared_ptr<XrdsUpscaler> of, const XrdsVulkanFrame& given);
  ~XrdsRecording();

  const std::shared_ptr<XrdsUpscaler> upscaler;
  std::list<xrds::Buffer> buffers;
  std::list<xrds::HostImage> images;
  std::optional<xrds::HostFrame> frame;
  std::optional<xrds::HostRecording> recording;
};

namespace {

using Recordings = Handles<XrdsRecording>;

void checkSizes(const XrdsVulkanImage& image, const std::string& what, uint32_t width, uint32_t height) {
  if (image.width != width || image.height != height)
    throw xrds::InvalidArgument("The " + what + " image is " + xrds::sizeText(image.width, image.height) +
                                " pixels, expected " + xrds::sizeText(width, height) + ".");
  if (const int format = numberOf(image.format); format != XRDS_FLOAT && format != XRDS_HALF)
    throw xrds::InvalidArgument("The " + what + " image has the format " + std::to_string(format) +
                                ", expected XRDS_FLOAT or XRDS_HALF.");
  if ((image.buffer == VK_NULL_HANDLE) == (image.image == VK_NULL_HANDLE))
    throw xrds::InvalidArgument("The " + what + " image has " + (image.buffer ? "both" : "neither") +
                                " a buffer and an image: give one of them.");
}

xrds::HostPixels pixelsOf(const XrdsVulkanImage& image, const std::string& what) {
  const uint32_t channels = image.image ? 4 : image.channelCount;
  const auto refused = [&](const std::string& found, const std::string& expected) {
    return xrds::InvalidArgument("The " + what + " image has " + found + ", expected " + expected + ".");
  };
  if (channels != 3 && channels != 4) throw refused(std::to_string(channels) + " channels", "3 or 4");
  xrds::HostPixels pixels{.width = image.width, .height = image.height, .channels = channels};
  if (image.format == XRDS_HALF) pixels.type = xrds::DataType::f16;
  const uint64_t row = uint64_t{image.width} * channels * xrds::byteSize(pixels.type);
  pixels.rowBytes = image.image || image.rowPitch == 0 ? row : image.rowPitch;
  if (image.image) return pixels;
  pixels.byteOffset = image.offset;
  if (pixels.rowBytes < row || pixels.rowBytes % 4 != 0 || pixels.rowBytes > uint32_t{1} << 30)
    throw refused("a row pitch of " + std::to_string(pixels.rowBytes) + " bytes",
                  "a multiple of 4, at least " + std::to_string(row));
  if (image.offset % 4 != 0) throw refused("an offset of " + std::to_string(image.offset), "a multiple of 4");
  return pixels;
}

xrds::HostPicture pictureOf(XrdsRecording& recording, const XrdsVulkanImage& image, const std::string& what,
                            uint32_t scale) {
  checkSize(image);
  const XrdsUpscaler& upscaler = *recording.upscaler;
  checkSizes(image, what, scale * upscaler.width, scale * upscaler.height);
  xrds::HostPicture picture{.pixels = pixelsOf(image, what)};
  if (image.image) {
    if (image.layout == VK_IMAGE_LAYOUT_UNDEFINED || image.layout == VK_IMAGE_LAYOUT_PREINITIALIZED)
      throw xrds::InvalidArgument("The " + what + " image is in no layout: name the one that it has before and after.");
    picture.image =
        &recording.images.emplace_back(xrds::HostImage{image.image, image.layout, image.width, image.height});
    return picture;
  }
  xrds::Gpu& gpu = xrds::EngineAccess::gpu(upscaler.device->device);
  const uint64_t end = xrds::alignUp(image.offset + picture.pixels.byteSize(), uint64_t{4});
  picture.buffer = &recording.buffers.emplace_back(xrds::hostBuffer(gpu, image.buffer, end));
  return picture;
}

void takeExposure(XrdsRecording& recording, const XrdsVulkanFrame& given, xrds::HostPictures& pictures) {
  pictures.exposure = xrds::EngineAccess::exposureOf(*recording.upscaler->upscaler);
  if (!given.exposure) return;
  if (!pictures.exposure)
    throw xrds::InvalidArgument(
        "An exposure was given to an upscaler that computes its own: create it with the option exposure 1.");
  if (given.exposureOffset % 4 != 0)
    throw xrds::InvalidArgument("The exposure lies at byte " + std::to_string(given.exposureOffset) +
                                ", expected a multiple of 4.");
  xrds::Gpu& gpu = xrds::EngineAccess::gpu(recording.upscaler->device->device);
  pictures.exposureBuffer =
      &recording.buffers.emplace_back(xrds::hostBuffer(gpu, given.exposure, given.exposureOffset + sizeof(float)));
  pictures.exposureOffset = given.exposureOffset;
}

void checkShared(const XrdsUpscaler& upscaler) {
  if (!xrds::EngineAccess::gpu(upscaler.device->device).isShared())
    throw xrds::InvalidArgument(
        "The upscaler is on a device of the library's own, which no command buffer of yours belongs to: open yours "
        "with "
        "xrdsOpenVulkanDevice().");
}

}  // namespace

XrdsRecording::XrdsRecording(std::shared_ptr<XrdsUpscaler> of, const XrdsVulkanFrame& given) : upscaler(std::move(of)) {
  const std::lock_guard lock(upscaler->device->access);
  checkShared(*upscaler);
  const xrds::Model& model = upscaler->model->model;
  const auto& inputs = model.auxiliaryInputs();
  if (given.auxiliaryCount != inputs.size())
    throw xrds::InvalidArgument("The model takes " + std::to_string(inputs.size()) + " auxiliary images, found " +
                                std::to_string(given.auxiliaryCount) + ".");
  xrds::HostPictures pictures;
  pictures.colour = pictureOf(*this, given.colour, "colour", 1);
  for (uint32_t i = 0; i < given.auxiliaryCount; ++i)
    pictures.auxiliary.push_back(
        pictureOf(*this, (&required(given.auxiliary, "auxiliary"))[i], inputs[i], model.scale()));
  pictures.output = pictureOf(*this, given.output, "output", model.scale());
  takeExposure(*this, given, pictures);
  xrds::Gpu& gpu = xrds::EngineAccess::gpu(upscaler->device->device);
  const auto parts = xrds::EngineAccess::parts(*upscaler->upscaler);
  frame.emplace(gpu, parts, pictures);
  recording.emplace(gpu, frame->dispatches());
}

XrdsRecording::~XrdsRecording() {
  const std::lock_guard lock(upscaler->device->access);
  recording.reset();
  frame.reset();
}

XrdsVulkanImage xrdsBufferImage(VkBuffer buffer, XrdsFormat format, uint32_t channelCount, uint32_t width,
                                uint32_t height) {
  return {.structSize = sizeof(XrdsVulkanImage),
          .width = width,
          .height = height,
          .format = format,
          .buffer = buffer,
          .channelCount = channelCount};
}

XrdsVulkanImage xrdsWholeImage(VkImage image, XrdsFormat format, uint32_t width, uint32_t height) {
  return {.structSize = sizeof(XrdsVulkanImage),
          .width = width,
          .height = height,
          .format = format,
          .layout = VK_IMAGE_LAYOUT_GENERAL,
          .image = image};
}

XrdsVulkanFrame xrdsVulkanFrameDefault() { return {.structSize = sizeof(XrdsVulkanFrame)}; }

XrdsResult xrdsCreateRecording(XrdsUpscaler* upscaler, const XrdsVulkanFrame* frame, XrdsRecording** recording) {
  return guarded([&] {
    XrdsRecording*& out = required(recording, "recording");
    const XrdsVulkanFrame& given = checkSize(required(frame, "frame"));
    const auto of = Upscalers::open().opened(upscaler, "upscaler");
    out = Recordings::open().add(std::make_shared<XrdsRecording>(of, given));
    return XRDS_OK;
  });
}

void xrdsDestroyRecording(XrdsRecording* recording) {
  guarded([&] {
    Recordings::open().remove(recording);
    return XRDS_OK;
  });
}

XrdsResult xrdsRecord(XrdsRecording* recording, VkCommandBuffer commandBuffer) {
  return guarded([&] {
    const auto found = Recordings::open().opened(recording, "recording");
    required(commandBuffer, "commandBuffer");
    found->recording->recordInto(commandBuffer);
    return XRDS_OK;
  });
}

XrdsResult xrdsSubmit(XrdsRecording* recording, const XrdsTimelinePoint* waits, uint32_t waitCount,
                      const XrdsTimelinePoint* signals, uint32_t signalCount) {
  return guarded([&] {
    const auto found = Recordings::open().opened(recording, "recording");
    const auto points = [](const XrdsTimelinePoint* given, uint32_t count, const char* name) {
      std::vector<xrds::TimelinePoint> read;
      for (uint32_t i = 0; i < count; ++i) {
        const XrdsTimelinePoint& point = (&required(given, name))[i];
        if (!point.semaphore)
          throw xrds::InvalidArgument("Semaphore " + std::to_string(i) + " of '" + name + "' is a null handle.");
        read.push_back({point.semaphore, point.value});
      }
      return read;
    };
    found->recording->submit(points(waits, waitCount, "waits"), points(signals, signalCount, "signals"));
    return XRDS_OK;
  });
}
