#include "viewer/prepared_network.h"

#include <algorithm>

#include "xrds/error.h"

namespace xrds {
namespace {

// Small enough for a CPU to finish one in about 10 ms: that long does a drawing wait for the network.
constexpr uint64_t kMultiplyAddsPerSubmission = uint64_t{1} << 26;

Model checked(Model model, const std::string& name, const FrameSize& frame) {
  if (frame.scale != 0 && !model.auxiliaryInputs().empty() && static_cast<int>(model.scale()) != frame.scale)
    throw Error("Model '" + name + "' upscales by " + std::to_string(model.scale()) +
                ", but the auxiliary images have " + std::to_string(frame.scale) + " times the colour's size.");
  for (const std::string& input : model.auxiliaryInputs())
    if (!frame.has(input)) throw Error("Model '" + name + "' needs the image '" + input + "', which is not there.");
  return model;
}

PixelView viewOfThree(const Image& image) {
  return {image.pixels.data(), static_cast<uint32_t>(image.width), static_cast<uint32_t>(image.height),
          static_cast<uint32_t>(image.channels)};
}

}  // namespace

bool FrameSize::has(const std::string& input) const {
  return std::find(inputs.begin(), inputs.end(), input) != inputs.end();
}

PreparedNetwork::PreparedNetwork(Device& device, std::string name, Model model, const FrameSize& frame, bool fp16)
    : name_(std::move(name)),
      model_(checked(std::move(model), name_, frame)),
      fp16_(fp16),
      width_(frame.width),
      height_(frame.height),
      upscaler_(device, model_, width_, height_,
                {.fp16 = fp16, .profile = true, .multiplyAddsPerSubmission = kMultiplyAddsPerSubmission}) {}

bool PreparedNetwork::fits(const FrameSize& frame) const {
  const auto& inputs = model_.auxiliaryInputs();
  return frame.width == width_ && frame.height == height_ &&
         std::all_of(inputs.begin(), inputs.end(), [&](const std::string& input) { return frame.has(input); });
}

void PreparedNetwork::upload(const LoadedFrame& frame) {
  std::vector<PixelView> auxiliary;
  for (const std::string& input : model_.auxiliaryInputs()) {
    const auto found = std::find(frame.inputs.begin(), frame.inputs.end(), input);
    auxiliary.push_back(viewOfThree(frame.auxiliary.at(static_cast<size_t>(found - frame.inputs.begin()))));
  }
  EngineAccess::upload(upscaler_, viewOfThree(frame.colour), auxiliary);
}

void PreparedNetwork::copyInputs(Gpu& gpu, const Buffer& colour, const Buffer& auxiliary) {
  const DeviceFrame frame = EngineAccess::frame(upscaler_);
  if (frame.auxiliary.channels != 0 && model_.auxiliaryInputs() != std::vector<std::string>{"albedo", "normal"})
    throw Error("Model '" + name_ + "' does not take albedo and normal, which is what a live view gives.");
  runOnce(gpu.handles(), [&](VkCommandBuffer commands) {
    const auto copy = [&](const Buffer& from, const DeviceImage& to) {
      const VkBufferCopy region{0, to.byteOffset, to.byteSize()};
      gpu.handles().vk.vkCmdCopyBuffer(commands, from.handles().buffer, frame.buffer->handles().buffer, 1, &region);
    };
    copy(colour, frame.colour);
    if (frame.auxiliary.channels != 0) copy(auxiliary, frame.auxiliary);
  });
}

void PreparedNetwork::showInputs(Pictures& pictures) const {
  const DeviceFrame frame = EngineAccess::frame(upscaler_);
  const VkBuffer buffer = frame.buffer->handles().buffer;
  std::vector<PictureSource> sources{{Slot::input, buffer, frame.colour.byteOffset}};
  pictures.resize(Slot::input, frame.colour.width, frame.colour.height, frame.colour.channels);
  if (frame.auxiliary.channels > 0) {
    pictures.resize(Slot::auxiliary, frame.auxiliary.width, frame.auxiliary.height, frame.auxiliary.channels);
    sources.push_back({Slot::auxiliary, buffer, frame.auxiliary.byteOffset});
  } else {
    pictures.invalidate(Slot::auxiliary);
  }
  pictures.copy(sources);
}

void PreparedNetwork::showOutput(Pictures& pictures, Slot slot) const {
  const DeviceFrame frame = EngineAccess::frame(upscaler_);
  pictures.resize(slot, frame.output.width, frame.output.height, frame.output.channels);
  const PictureSource source{slot, frame.buffer->handles().buffer, frame.output.byteOffset};
  pictures.copy({&source, 1});
}

Image PreparedNetwork::download() const {
  const DeviceImage output = EngineAccess::frame(upscaler_).output;
  Image image(static_cast<int>(output.width), static_cast<int>(output.height), 3);
  EngineAccess::download(upscaler_, image.pixels);
  return image;
}

}  // namespace xrds
