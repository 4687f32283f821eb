#include "api/frame_recording.h"

#include <limits>
#include <list>

#include "api/arguments.h"
#include "api/c/result.h"
#include "api/c/sized.h"
#include "engine/host_device.h"
#include "engine/host_recording.h"
#include "frames/denoised_frame.h"
#include "network/oidn.h"

namespace xrds {

using c::checkSize, c::numberOf, c::required;

struct RecordedFrame::State {
  State(FrameUpscaler& upscaler, const XrdsVulkanFrame& given, const FrameUpscaler* alpha);
  HostPicture pictureOf(const XrdsVulkanImage& image, const std::string& what, uint32_t scale, uint32_t fewest = 3);
  std::span<const PlacedDispatch> dispatches() const { return frame ? frame->dispatches() : denoised->dispatches(); }
  void takeExposure(const XrdsVulkanFrame& given, HostPictures& pictures);

  Gpu& gpu;
  const Upscaler::Options& options;
  const NetworkConfig& config;
  const FrameShape shape;
  std::list<Buffer> buffers;
  std::list<HostImage> images;
  std::vector<FramePart> parts, alphaParts;
  std::shared_ptr<const void> hold;  // of the parts
  std::optional<HostFrame> frame;
  std::optional<DenoisedFrame> denoised;  // in place of the frame
  std::optional<HostRecording> recording;
  std::optional<Recording> ownRuns;  // made by the first run()
};

namespace {

void checkSizes(const XrdsVulkanImage& image, const std::string& what, uint32_t width, uint32_t height) {
  if (image.width != width || image.height != height)
    throw InvalidArgument("The " + what + " image is " + sizeText(image.width, image.height) + " pixels, expected " +
                          sizeText(width, height) + ".");
  if (const int format = numberOf(image.format); format != XRDS_FLOAT && format != XRDS_HALF)
    throw InvalidArgument("The " + what + " image has the format " + std::to_string(format) +
                          ", expected XRDS_FLOAT or XRDS_HALF.");
  if ((image.buffer == VK_NULL_HANDLE) == (image.image == VK_NULL_HANDLE))
    throw InvalidArgument("The " + what + " image has " + (image.buffer ? "both" : "neither") +
                          " a buffer and an image: give one of them.");
}

// Of `fewest` channels or 4.
HostPixels pixelsOf(const XrdsVulkanImage& image, const std::string& what, uint32_t fewest) {
  const uint32_t channels = image.image ? 4 : image.channelCount;
  const auto refused = [&](const std::string& found, const std::string& expected) {
    return InvalidArgument("The " + what + " image has " + found + ", expected " + expected + ".");
  };
  if (channels != fewest && channels != 4)
    throw refused(std::to_string(channels) + " channels", (fewest == 4 ? "" : std::to_string(fewest) + " or ") + "4");
  HostPixels pixels{.width = image.width, .height = image.height, .channels = channels};
  if (image.format == XRDS_HALF) pixels.type = DataType::f16;
  const uint64_t row = uint64_t{image.width} * channels * byteSize(pixels.type);
  pixels.rowBytes = image.image || image.rowPitch == 0 ? row : image.rowPitch;
  if (image.image) return pixels;
  pixels.byteOffset = image.offset;
  if (pixels.rowBytes < row || pixels.rowBytes % 4 != 0 || pixels.rowBytes > uint32_t{1} << 30)
    throw refused("a row pitch of " + std::to_string(pixels.rowBytes) + " bytes",
                  "a multiple of 4, at least " + std::to_string(row));
  if (image.offset % 4 != 0) throw refused("an offset of " + std::to_string(image.offset), "a multiple of 4");
  return pixels;
}

// Where bytes behind an offset end; beyond all buffers if that is no number.
uint64_t endOf(uint64_t offset, uint64_t byteSize) {
  constexpr uint64_t kMost = std::numeric_limits<uint64_t>::max();
  return offset > kMost - byteSize ? kMost : offset + byteSize;
}

Gpu& sharedDevice(const FrameUpscaler& upscaler) {
  Gpu& gpu = upscaler.gpu();
  if (!gpu.isShared())
    throw InvalidArgument(
        "The upscaler is on a device of the library's own, which no command buffer of yours belongs to: open yours "
        "with xrdsOpenVulkanDevice().");
  return gpu;
}

std::vector<TimelinePoint> pointsOf(std::span<const XrdsTimelinePoint> given, const char* name) {
  std::vector<TimelinePoint> points;
  for (const XrdsTimelinePoint& point : given) {
    if (!point.semaphore)
      throw InvalidArgument("Semaphore " + std::to_string(points.size()) + " of '" + name + "' is a null handle.");
    points.push_back({point.semaphore, point.value});
  }
  return points;
}

}  // namespace

HostPicture RecordedFrame::State::pictureOf(const XrdsVulkanImage& image, const std::string& what, uint32_t scale,
                                            uint32_t fewest) {
  checkSize(image);
  checkSizes(image, what, scale * shape.width, scale * shape.height);
  HostPicture picture{.pixels = pixelsOf(image, what, fewest)};
  if (image.image) {
    if (image.layout == VK_IMAGE_LAYOUT_UNDEFINED || image.layout == VK_IMAGE_LAYOUT_PREINITIALIZED)
      throw InvalidArgument("The " + what + " image is in no layout: name the one that it has before and after.");
    picture.image = &images.emplace_back(HostImage{image.image, image.layout, image.width, image.height});
    return picture;
  }
  const uint64_t end = endOf(image.offset, alignUp(picture.pixels.byteSize(), uint64_t{4}));
  picture.buffer = &buffers.emplace_back(hostBuffer(gpu, image.buffer, end));
  return picture;
}

void RecordedFrame::State::takeExposure(const XrdsVulkanFrame& given, HostPictures& pictures) {
  pictures.exposure = options.exposure;
  if (!given.exposure) return;
  if (!pictures.exposure)
    throw InvalidArgument(
        "An exposure was given to an upscaler that computes its own: create it with the option exposure 1.");
  if (given.exposureOffset % 4 != 0)
    throw InvalidArgument("The exposure lies at byte " + std::to_string(given.exposureOffset) +
                          ", expected a multiple of 4.");
  pictures.exposureBuffer =
      &buffers.emplace_back(hostBuffer(gpu, given.exposure, endOf(given.exposureOffset, sizeof(float))));
  pictures.exposureOffset = given.exposureOffset;
}

RecordedFrame::State::State(FrameUpscaler& upscaler, const XrdsVulkanFrame& given, const FrameUpscaler* alpha)
    : gpu(sharedDevice(upscaler)), options(upscaler.options()), config(upscaler.config()), shape(upscaler.shape()) {
  const auto& inputs = config.auxInputs;
  if (given.auxiliaryCount != inputs.size())
    throw InvalidArgument("The model takes " + std::to_string(inputs.size()) + " auxiliary images, found " +
                          std::to_string(given.auxiliaryCount) + ".");
  HostPictures pictures;
  pictures.colour = pictureOf(given.colour, "colour", 1);
  for (uint32_t i = 0; i < given.auxiliaryCount; ++i)
    pictures.auxiliary.push_back(pictureOf((&required(given.auxiliary, "auxiliary"))[i], inputs[i], config.scale));
  pictures.output = pictureOf(given.output, "output", config.scale, alpha ? 4 : 3);
  if (alpha) {
    pictures.alpha = pictureOf(*given.alpha, "alpha", 1, 1);
    alphaParts = alpha->parts();
  }
  takeExposure(given, pictures);
  pictures.binnedExposure = takesBinnedExposure(config);
  parts = upscaler.parts();
  hold = upscaler.hold();
  if (const DenoisingParts* const denoising = upscaler.denoising())
    denoised.emplace(gpu, *denoising, parts, inputs, pictures, alphaParts);
  else
    frame.emplace(gpu, parts, pictures, alphaParts);
  recording.emplace(gpu, dispatches());
}

RecordedFrame::RecordedFrame(FrameUpscaler& upscaler, const XrdsVulkanFrame& frame, const FrameUpscaler* alpha)
    : state_(std::make_unique<State>(upscaler, frame, alpha)) {}
RecordedFrame::~RecordedFrame() = default;

void RecordedFrame::record(VkCommandBuffer commands) const {
  state_->recording->recordInto(&required(commands, "commandBuffer"));
}

void RecordedFrame::submit(std::span<const XrdsTimelinePoint> waits, std::span<const XrdsTimelinePoint> signals) {
  state_->recording->submit(pointsOf(waits, "waits"), pointsOf(signals, "signals"));
}

bool RecordedFrame::run(const Upscaler::Progress& progress) {
  const RecordingOptions asked{.timestamps = state_->options.profile,
                               .multiplyAddsPerSubmission = state_->options.multiplyAddsPerSubmission,
                               .measuresPace = true};
  if (!state_->ownRuns) state_->ownRuns.emplace(state_->gpu, state_->dispatches(), asked);
  return state_->ownRuns->run(countingShare(progress));
}

float RecordedFrame::exposure() const { return state_->parts.front().session->exposure(); }

std::vector<Upscaler::ProfileRow> RecordedFrame::profile() const {
  if (!state_->ownRuns) return {};
  return profileRows(timesOf(state_->dispatches(), state_->ownRuns->gpuMicroseconds()));
}

}  // namespace xrds
