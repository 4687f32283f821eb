#include "viewer/prepared_network.h"

#include <algorithm>
#include <tuple>

#include "app/failing_with.h"
#include "app/skip_map.h"
#include "xrds/error.h"

namespace xrds {
namespace {

Model checked(Model model, const std::string& name, const FrameSize& frame) {
  if (frame.scale != 0 && !model.auxiliaryInputs().empty() && static_cast<int>(model.scale()) != frame.scale)
    throw Error("Model '" + name + "' upscales by " + std::to_string(model.scale()) +
                ", but the auxiliary images have " + std::to_string(frame.scale) + " times the colour's size.");
  for (const std::string& input : model.auxiliaryInputs())
    if (!frame.has(input)) throw Error("Model '" + name + "' needs the image '" + input + "', which is not there.");
  return model;
}

Upscaler::Options upscalerOptions(const NetworkOptions& options) {
  return {.fp16 = options.fp16,
          .profile = true,
          .tiles = {.memoryBytes = options.memoryBytes},
          .skip = options.skip,
          .multiplyAddsPerSubmission = options.multiplyAddsAtOnce,
          .tune = options.tune,
          .onTuning = options.onTuning};
}

std::vector<float> downloaded(const Buffer& buffer, uint64_t floats) {
  std::vector<float> values(floats);
  buffer.download(0, std::as_writable_bytes(std::span(values)));
  return values;
}

// Images side by side in the channels of one, as texels.
std::vector<float> interleaved(std::span<const PixelView> images, uint32_t channels) {
  const size_t pixels = size_t{images[0].width} * images[0].height;
  std::vector<float> packed(pixels * channels);
  for (size_t i = 0; i < images.size(); ++i)
    for (size_t p = 0; p < pixels; ++p)
      std::copy_n(images[i].pixels + p * images[i].stride, 3, &packed[p * channels + 3 * i]);
  return packed;
}

}  // namespace

bool operator==(const NetworkOptions& a, const NetworkOptions& b) {
  const auto all = [](const NetworkOptions& o) {
    return std::tuple(o.fp16, o.skip.bound, o.skip.keepUnchanged, o.memoryBytes);
  };
  return all(a) == all(b);
}

bool FrameSize::has(const std::string& input) const {
  return std::find(inputs.begin(), inputs.end(), input) != inputs.end();
}

PreparedNetwork::PreparedNetwork(Device& device, std::string name, Model model, const FrameSize& frame,
                                 const NetworkOptions& options)
    : name_(std::move(name)),
      model_(failingWith(ExitCode::model, [&] { return checked(std::move(model), name_, frame); })),
      options_(options),
      width_(frame.width),
      height_(frame.height),
      upscaler_(device, model_, width_, height_, upscalerOptions(options)) {}

bool PreparedNetwork::fits(const FrameSize& frame) const {
  const auto& inputs = model_.auxiliaryInputs();
  return frame.width == width_ && frame.height == height_ &&
         std::all_of(inputs.begin(), inputs.end(), [&](const std::string& input) { return frame.has(input); });
}

void PreparedNetwork::take(const LoadedFrame& frame) {
  colour_ = viewOf(frame.colour);
  auxiliary_ = inputsOf(model_, frame.inputs, frame.auxiliary);
  if (isOnDevice()) EngineAccess::upload(upscaler_, colour_, auxiliary_);
}

void PreparedNetwork::take(Gpu& gpu, const Buffer& colour, const Buffer& auxiliary) {
  const bool takesAuxiliary = !model_.auxiliaryInputs().empty();
  if (takesAuxiliary && model_.auxiliaryInputs() != std::vector<std::string>{"albedo", "normal"})
    throw Error("Model '" + name_ + "' does not take albedo and normal, which is what a live view gives.");
  if (isOnDevice()) return copyOnDevice(gpu, colour, auxiliary);
  const uint32_t scale = model_.scale(), wide = scale * width_, high = scale * height_;
  copiedColour_ = downloaded(colour, uint64_t{4} * width_ * height_);
  colour_ = {copiedColour_.data(), width_, height_, 4};
  auxiliary_.clear();
  if (!takesAuxiliary) return;
  copiedAuxiliary_ = downloaded(auxiliary, uint64_t{8} * wide * high);
  auxiliary_ = {{copiedAuxiliary_.data(), wide, high, 8}, {copiedAuxiliary_.data() + 3, wide, high, 8}};
}

void PreparedNetwork::copyOnDevice(Gpu& gpu, const Buffer& colour, const Buffer& auxiliary) {
  const DeviceFrame frame = EngineAccess::frame(upscaler_);
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
  if (model_.auxiliaryInputs().empty()) pictures.invalidate(Slot::auxiliary);
  if (!isOnDevice()) {
    pictures.upload(Slot::input, width_, height_, 4, interleaved({&colour_, 1}, 4));
    if (auxiliary_.empty()) return;
    const auto channels = static_cast<uint32_t>((3 * auxiliary_.size() + 3) / 4 * 4);
    pictures.upload(Slot::auxiliary, auxiliary_[0].width, auxiliary_[0].height, channels,
                    interleaved(auxiliary_, channels));
    return;
  }
  const DeviceFrame frame = EngineAccess::frame(upscaler_);
  const VkBuffer buffer = frame.buffer->handles().buffer;
  std::vector<PictureSource> sources{{Slot::input, buffer, frame.colour.byteOffset}};
  pictures.resize(Slot::input, frame.colour.width, frame.colour.height, frame.colour.channels);
  if (frame.auxiliary.channels > 0) {
    pictures.resize(Slot::auxiliary, frame.auxiliary.width, frame.auxiliary.height, frame.auxiliary.channels);
    sources.push_back({Slot::auxiliary, buffer, frame.auxiliary.byteOffset});
  }
  pictures.copy(sources);
}

bool PreparedNetwork::run(const Upscaler::Progress& progress) {
  if (isOnDevice()) return EngineAccess::replay(upscaler_, progress);
  if (output_.empty()) fillOutput();
  return upscaler_.run(colour_, auxiliary_, output_, progress);
}

// Until the first tiles are there the colour stands in for them.
void PreparedNetwork::fillOutput() {
  const uint32_t scale = model_.scale();
  const size_t wide = size_t{scale} * width_, high = size_t{scale} * height_;
  output_.resize(3 * wide * high);
  for (size_t y = 0; y < high; ++y)
    for (size_t x = 0; x < wide; ++x)
      std::copy_n(colour_.pixels + colour_.stride * (y / scale * width_ + x / scale), 3, &output_[3 * (y * wide + x)]);
}

void PreparedNetwork::showOutput(Pictures& pictures, Slot slot) const {
  if (!isOnDevice()) {
    const PixelView view{output_.data(), model_.scale() * width_, model_.scale() * height_};
    return pictures.upload(slot, view.width, view.height, 4, interleaved({&view, 1}, 4));
  }
  const DeviceFrame frame = EngineAccess::frame(upscaler_);
  pictures.resize(slot, frame.output.width, frame.output.height, frame.output.channels);
  const PictureSource source{slot, frame.buffer->handles().buffer, frame.output.byteOffset};
  pictures.copy({&source, 1});
}

void PreparedNetwork::showSkipMap(Pictures& pictures) const {
  if (isOnDevice() && pictures.at(Slot::skipMap).valid) return;  // everything is computed, always
  const SkipMap map = upscaler_.skipMap();
  std::vector<float> tints;
  for (const SkipMap::Window window : map.windows) {
    const std::array<float, 4> tint = skipTint(window);
    tints.insert(tints.end(), tint.begin(), tint.end());
  }
  pictures.upload(Slot::skipMap, map.columns, map.rows, 4, tints);
}

uint64_t PreparedNetwork::paceFor(double runMilliseconds) const {
  constexpr double kSubmissionMilliseconds = 10;
  double multiplyAdds = 0, microseconds = 0;
  for (const Upscaler::ProfileRow& row : upscaler_.profile()) {
    multiplyAdds += static_cast<double>(row.multiplyAdds);
    microseconds += row.microseconds;
  }
  const double milliseconds = microseconds > 0 ? microseconds / 1000 : runMilliseconds;
  if (multiplyAdds == 0 || milliseconds <= 0) return options_.multiplyAddsAtOnce;
  return static_cast<uint64_t>(std::clamp(multiplyAdds * kSubmissionMilliseconds / milliseconds, 0x1p20, 0x1p40));
}

Image PreparedNetwork::download() const {
  Image image(static_cast<int>(model_.scale() * width_), static_cast<int>(model_.scale() * height_), 3);
  if (isOnDevice())
    EngineAccess::download(upscaler_, image.pixels);
  else
    image.pixels = output_;
  return image;
}

}  // namespace xrds
