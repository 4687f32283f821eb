#include "viewer/upscaling/prepared_network.h"

#include <algorithm>
#include <tuple>

#include "app/failing_with.h"
#include "app/skip_map.h"
#include "xrds/error.h"
#include "xrds/merged_colour.h"

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

Upscaler::Options upscalerOptions(const Device& device, const Model& model, const FrameSize& frame,
                                  const NetworkOptions& options) {
  Upscaler::Options asked{
      .fp16 = options.fp16,
      .exposure = options.exposure,
      .profile = true,
      .ensemble = options.ensemble,
      .tiles = {.memoryBytes = options.memoryBytes, .exact = options.exactTiles, .wrap = options.wrap},
      .skip = options.skip,
      .multiplyAddsPerSubmission = options.multiplyAddsAtOnce,
      .tune = options.tune,
      .denoisers = options.denoisers,
      .onTuning = options.onTuning};
  // Of a device of its own an upscaler decides that itself.
  if (asked.tune == Upscaler::Tune::automatic &&
      Upscaler::paysToTune(device, model, frame.width, frame.height, options.fp16))
    asked.tune = Upscaler::Tune::now;
  return asked;
}

std::vector<float> downloaded(const DeviceBuffer& buffer, uint64_t floats) {
  std::vector<float> values(floats);
  buffer.download(0, std::as_writable_bytes(std::span(values)));
  return values;
}

// Images as the planes of one: [height, images, width, 4].
std::vector<float> inPlanes(std::span<const PixelView> images) {
  const uint32_t wide = images[0].width, high = images[0].height;
  std::vector<float> packed(size_t{4} * images.size() * wide * high);
  float* to = packed.data();
  for (size_t y = 0; y < high; ++y)
    for (const PixelView& image : images)
      for (size_t x = 0; x < wide; ++x, to += 4) std::copy_n(image.pixels + (y * wide + x) * image.stride, 3, to);
  return packed;
}

// One plane of such an image, four floats a pixel.
std::vector<float> plane(std::span<const float> planes, uint32_t count, uint32_t index, uint32_t wide, uint32_t high) {
  const size_t row = size_t{4} * wide;
  std::vector<float> one(row * high);
  for (size_t y = 0; y < high; ++y) std::copy_n(&planes[(y * count + index) * row], row, &one[y * row]);
  return one;
}

// The images of a frame in one buffer, as xrds reads them.
std::vector<XrdsVulkanImage> planesOf(const DeviceBuffer& buffer, uint32_t count, uint32_t wide, uint32_t high) {
  const uint64_t rowBytes = uint64_t{16} * wide;
  std::vector<XrdsVulkanImage> images(count, xrdsBufferImage(buffer.buffer(), XRDS_FLOAT, 4, wide, high));
  for (uint32_t i = 0; i < count; ++i) {
    images[i].offset = i * rowBytes;
    images[i].rowPitch = count * rowBytes;
  }
  return images;
}

uint32_t planeCount(const Model& model) { return static_cast<uint32_t>(model.auxiliaryInputs().size()); }

}  // namespace

bool operator==(const NetworkOptions& a, const NetworkOptions& b) {
  const auto all = [](const NetworkOptions& o) {
    return std::tuple(o.fp16, o.exposure, o.ensemble, o.wrap, o.skip.bound, o.skip.keepUnchanged, o.denoisers.colour,
                      o.denoisers.albedo, o.denoisers.normal, o.exactTiles, o.memoryBytes);
  };
  return all(a) == all(b);
}

bool FrameSize::has(const std::string& input) const {
  return std::find(inputs.begin(), inputs.end(), input) != inputs.end();
}

PreparedNetwork::PreparedNetwork(VulkanDevice& vulkan, Device& device, std::string name, Model model,
                                 const FrameSize& frame, const NetworkOptions& options)
    : vulkan_(vulkan),
      name_(std::move(name)),
      model_(failingWith(ExitCode::model, [&] { return checked(std::move(model), name_, frame); })),
      options_(options),
      width_(frame.width),
      height_(frame.height),
      upscaler_(device, model_, width_, height_, upscalerOptions(device, model_, frame, options)) {
  if (tileCount() > 1) return;  // which are shown as they are finished
  try {
    record();
  } catch (const InvalidArgument&) {  // its frames are not recorded, such as those of several passes
    deviceColour_.reset();
    deviceAuxiliary_.reset();
    deviceOutput_.reset();
  }
}

void PreparedNetwork::record() {
  const uint32_t scale = model_.scale(), wide = scale * width_, high = scale * height_, count = planeCount(model_);
  const auto imageOf = [&](std::unique_ptr<DeviceBuffer>& buffer, uint32_t width, uint32_t height, uint32_t planes) {
    buffer = std::make_unique<DeviceBuffer>(vulkan_, uint64_t{16} * planes * width * height);
    return planesOf(*buffer, planes, width, height);
  };
  XrdsVulkanFrame frame = xrdsVulkanFrameDefault();
  frame.colour = imageOf(deviceColour_, width_, height_, 1).front();
  frame.output = imageOf(deviceOutput_, wide, high, 1).front();
  std::vector<XrdsVulkanImage> auxiliary;
  if (count > 0) auxiliary = imageOf(deviceAuxiliary_, wide, high, count);
  frame.auxiliary = auxiliary.data();
  frame.auxiliaryCount = count;
  recording_.emplace(upscaler_, frame);
}

bool PreparedNetwork::fits(const FrameSize& frame) const {
  const auto& inputs = model_.auxiliaryInputs();
  return frame.width == width_ && frame.height == height_ &&
         std::all_of(inputs.begin(), inputs.end(), [&](const std::string& input) { return frame.has(input); });
}

void PreparedNetwork::take(const LoadedFrame& frame) {
  std::vector<PixelView> auxiliary = inputsOf(model_, frame.inputs, frame.auxiliary);
  const auto& inputs = model_.auxiliaryInputs();
  for (size_t i = 0; i < inputs.size(); ++i)
    if (options_.denoisers.colour && !options_.denoisers.level && inputs[i] == kFullColour.name) {
      levelledFull_ = levelledColour(auxiliary[i], viewOf(frame.colour));
      auxiliary[i] = {levelledFull_.data(), auxiliary[i].width, auxiliary[i].height};
    }
  take(viewOf(frame.colour), std::move(auxiliary));
}

void PreparedNetwork::takeLive(const PixelView& colour, const PixelView& albedo, const PixelView& normal) {
  requireLiveInputs();
  take(colour, planeCount(model_) > 0 ? std::vector{albedo, normal} : std::vector<PixelView>{});
}

void PreparedNetwork::requireLiveInputs() const {
  if (planeCount(model_) > 0 && model_.auxiliaryInputs() != std::vector<std::string>{"albedo", "normal"})
    throw Error("Model '" + name_ + "' does not take albedo and normal, which is what a live view gives.");
}

void PreparedNetwork::take(const PixelView& colour, std::vector<PixelView> auxiliary) {
  colour_ = colour;
  auxiliary_ = std::move(auxiliary);
  if (!isOnDevice()) return;
  const auto upload = [](DeviceBuffer& to, std::span<const float> pixels) { to.upload(0, std::as_bytes(pixels)); };
  upload(*deviceColour_, inPlanes({&colour_, 1}));
  if (deviceAuxiliary_) upload(*deviceAuxiliary_, inPlanes(auxiliary_));
}

void PreparedNetwork::take(const DeviceBuffer& colour, const DeviceBuffer& auxiliary) {
  requireLiveInputs();
  const uint32_t count = planeCount(model_);
  if (isOnDevice()) {
    vulkan_.runOnce([&](VkCommandBuffer commands) {
      const auto copy = [&](const DeviceBuffer& from, const DeviceBuffer& to) {
        const VkBufferCopy region{0, 0, to.byteSize()};
        vkCmdCopyBuffer(commands, from.buffer(), to.buffer(), 1, &region);
      };
      copy(colour, *deviceColour_);
      if (deviceAuxiliary_) copy(auxiliary, *deviceAuxiliary_);
    });
    return;
  }
  const uint32_t scale = model_.scale(), wide = scale * width_, high = scale * height_;
  copiedColour_ = downloaded(colour, uint64_t{4} * width_ * height_);
  colour_ = {copiedColour_.data(), width_, height_, 4};
  auxiliary_.clear();
  copiedAuxiliary_.clear();
  if (count == 0) return;
  const std::vector<float> planes = downloaded(auxiliary, uint64_t{4} * count * wide * high);
  for (uint32_t i = 0; i < count; ++i) {
    copiedAuxiliary_.push_back(plane(planes, count, i, wide, high));
    auxiliary_.push_back({copiedAuxiliary_.back().data(), wide, high, 4});
  }
}

void PreparedNetwork::showInputs(Pictures& pictures) const {
  const uint32_t count = planeCount(model_), scale = model_.scale();
  if (count == 0) pictures.invalidate(Slot::auxiliary);
  if (!isOnDevice()) {
    pictures.upload(Slot::input, width_, height_, 1, inPlanes({&colour_, 1}));
    if (count > 0) pictures.upload(Slot::auxiliary, scale * width_, scale * height_, count, inPlanes(auxiliary_));
    return;
  }
  std::vector<PictureSource> sources{{Slot::input, deviceColour_.get()}};
  pictures.resize(Slot::input, width_, height_, 1);
  if (count > 0) {
    pictures.resize(Slot::auxiliary, scale * width_, scale * height_, count);
    sources.push_back({Slot::auxiliary, deviceAuxiliary_.get()});
  }
  pictures.copy(sources);
}

bool PreparedNetwork::run(const Upscaler::Progress& progress) {
  if (isOnDevice()) return recording_->run(progress);
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
  const uint32_t wide = model_.scale() * width_, high = model_.scale() * height_;
  if (!isOnDevice()) {
    const PixelView view{output_.data(), wide, high};
    return pictures.upload(slot, wide, high, 1, inPlanes({&view, 1}));
  }
  pictures.resize(slot, wide, high, 1);
  const PictureSource source{slot, deviceOutput_.get()};
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
  pictures.upload(Slot::skipMap, map.columns, map.rows, 1, tints);
}

std::vector<Upscaler::ProfileRow> PreparedNetwork::profile() const {
  return isOnDevice() ? recording_->profile() : upscaler_.profile();
}

float PreparedNetwork::exposure() const { return isOnDevice() ? recording_->exposure() : upscaler_.exposure(); }

uint64_t PreparedNetwork::deviceBytes() const {
  uint64_t sum = upscaler_.deviceBytes();
  for (const auto* buffer : {&deviceColour_, &deviceAuxiliary_, &deviceOutput_})
    if (*buffer) sum += (*buffer)->byteSize();
  return sum;
}

uint64_t PreparedNetwork::paceFor(double runMilliseconds) const {
  constexpr double kSubmissionMilliseconds = 10;
  // A run that computes little is ruled by what each submission costs.
  if (!isOnDevice() && upscaler_.skipMap().share(SkipMap::Window::kept) > 0) return options_.multiplyAddsAtOnce;
  double multiplyAdds = 0, microseconds = 0;
  for (const Upscaler::ProfileRow& row : profile()) {
    multiplyAdds += static_cast<double>(row.multiplyAdds);
    microseconds += row.microseconds;
  }
  const double milliseconds = microseconds > 0 ? microseconds / 1000 : runMilliseconds;
  if (multiplyAdds == 0 || milliseconds <= 0) return options_.multiplyAddsAtOnce;
  return static_cast<uint64_t>(std::clamp(multiplyAdds * kSubmissionMilliseconds / milliseconds, 0x1p20, 0x1p40));
}

Image PreparedNetwork::download() const {
  Image image(static_cast<int>(model_.scale() * width_), static_cast<int>(model_.scale() * height_), 3);
  if (!isOnDevice()) {
    image.pixels = output_;
    return image;
  }
  const std::vector<float> texels = downloaded(*deviceOutput_, 4 * image.pixelCount());
  for (size_t p = 0; p < image.pixelCount(); ++p) std::copy_n(&texels[4 * p], 3, &image.pixels[3 * p]);
  return image;
}

}  // namespace xrds
