#include "api/c/handles.h"
#include "api/c/images.h"
#include "api/c/layers.h"
#include "api/c/result.h"
#include "api/c/sized.h"
#include "xrds/auxiliary_input.h"

using namespace xrds::c;

XrdsUpscaler::XrdsUpscaler(std::shared_ptr<XrdsDevice> on, std::shared_ptr<XrdsModel> of, uint32_t frameWidth,
                           uint32_t frameHeight, const xrds::Upscaler::Options& options)
    : device(std::move(on)), model(std::move(of)), width(frameWidth), height(frameHeight), tiles(options.tiles) {
  const std::lock_guard lock(device->access);
  upscaler.emplace(device->device, model->model, width, height, options);
}

XrdsUpscaler::~XrdsUpscaler() {
  const std::lock_guard lock(device->access);
  alpha.reset();
  upscaler.reset();
}

namespace {

xrds::Upscaler::Options optionsOf(const XrdsUpscalerOptions& given) {
  xrds::Upscaler::Options options{.fp16 = given.fp16 != 0, .ensemble = given.ensemble};
  if (given.exposure != 0) options.exposure = given.exposure;
  options.tiles.memoryBytes = given.memoryBytes;
  constexpr xrds::Upscaler::Tune kTunes[] = {xrds::Upscaler::Tune::automatic, xrds::Upscaler::Tune::never,
                                             xrds::Upscaler::Tune::now};
  if (const int tune = numberOf(given.tune); tune < XRDS_TUNE_AUTO || tune > XRDS_TUNE_NOW)
    throw xrds::InvalidArgument("The option tune is " + std::to_string(tune) +
                                ", expected XRDS_TUNE_AUTO, XRDS_TUNE_NEVER or XRDS_TUNE_NOW.");
  options.tune = kTunes[given.tune];
  options.skip = {.bound = given.skipBound, .keepUnchanged = given.keepUnchanged != 0};
  return options;
}

ReadImage readAuxiliary(const XrdsImage& image, const std::string& input) {
  const xrds::AuxiliaryInput* kind = xrds::findAuxiliaryInput(input);
  if (!kind || !kind->isDistance || image.channels[1]) return {image, input};
  checkImage(image, input, 1);
  return {xrds::relativeDepth(readChannel(image, 0)), image.width, image.height};
}

void checkOutput(const XrdsUpscaler& upscaler, const XrdsImage& output) {
  checkImage(output, "output", 3);
  const uint32_t scale = upscaler.model->model.scale();
  if (output.width != scale * upscaler.width || output.height != scale * upscaler.height)
    throw xrds::InvalidArgument("The output image is " + std::to_string(output.width) + " x " +
                                std::to_string(output.height) + " pixels, expected " +
                                std::to_string(scale * upscaler.width) + " x " +
                                std::to_string(scale * upscaler.height) + ".");
}

// The colour's alpha at the size of the output, or opaque.
void writeAlpha(XrdsUpscaler& upscaler, const XrdsImage& colour, const XrdsImage& output) {
  if (!output.channels[3]) return;
  if (!colour.channels[3]) {
    const float opaque = 1;
    writeChannel(output, 3, &opaque, 0);
    return;
  }
  if (!upscaler.alpha)
    upscaler.alpha.emplace(upscaler.device->device, upscaler.width, upscaler.height, upscaler.model->model.scale(),
                           upscaler.tiles);
  writeChannel(output, 3, upscaler.alpha->run(readChannel(colour, 3)).data(), 1);
}

bool runInto(XrdsUpscaler& upscaler, const ReadImage& colour, const std::vector<xrds::PixelView>& auxiliary,
             const XrdsImage& output, std::span<const xrds::LayerSet> layers,
             const xrds::Upscaler::Progress& progress) {
  const size_t numbers = size_t{3} * output.width * output.height;
  if (isPacked(output))
    return upscaler.upscaler->run(colour.view(), auxiliary, {static_cast<float*>(output.channels[0]), numbers}, layers,
                                  progress);
  std::vector<float> pixels(numbers);
  if (!upscaler.upscaler->run(colour.view(), auxiliary, pixels, layers, progress)) return false;
  for (uint32_t c = 0; c < 3; ++c) writeChannel(output, c, &pixels[c], 3);
  return true;
}

/// What a call is given beside the colour and the output.
struct Frame {
  const XrdsImage* auxiliary = nullptr;
  uint32_t count = 0;
  const XrdsLayerSet* sets = nullptr;
  uint32_t setCount = 0;
  XrdsLayerReport* reports = nullptr;  // may be null
};

XrdsResult upscale(XrdsUpscaler& upscaler, const XrdsImage& colour, const Frame& frame, const XrdsImage& output,
                   const xrds::Upscaler::Progress& progress) {
  const auto& inputs = upscaler.model->model.auxiliaryInputs();
  if (frame.count != inputs.size())
    throw xrds::InvalidArgument("The model takes " + std::to_string(inputs.size()) + " auxiliary images, found " +
                                std::to_string(frame.count) + ".");
  checkOutput(upscaler, output);
  const ReadImage low(colour, "colour");
  std::vector<ReadImage> images;
  images.reserve(frame.count);
  for (uint32_t i = 0; i < frame.count; ++i)
    images.push_back(readAuxiliary((&required(frame.auxiliary, "auxiliary"))[i], inputs[i]));
  std::vector<xrds::PixelView> views;
  views.reserve(frame.count);
  for (const ReadImage& image : images) views.push_back(image.view());
  Layers layers;
  for (uint32_t i = 0; i < frame.setCount; ++i) {
    layers.add((&required(frame.sets, "sets"))[i]);
    if (frame.reports) checkSize(frame.reports[i]);
  }
  const std::lock_guard lock(upscaler.device->access);
  if (!runInto(upscaler, low, views, output, layers.sets(), progress))
    return failed(XRDS_CANCELLED, "The frame was cancelled.");
  writeAlpha(upscaler, colour, output);
  layers.write();
  for (uint32_t i = 0; frame.reports && i < frame.setCount; ++i) {
    const xrds::LayerReport& report = upscaler.upscaler->layerReports()[i];
    frame.reports[i] = {sizeof(XrdsLayerReport), report.share, report.raisedColours, report.unshared};
  }
  return XRDS_OK;
}

XrdsResult upscaleGuarded(XrdsUpscaler* upscaler, const XrdsImage* colour, const Frame& frame, const XrdsImage* output,
                          XrdsProgress progress, void* user) {
  return guarded([&] {
    const auto found = Upscalers::open().opened(upscaler, "upscaler");
    const std::unique_lock lock(found->use, std::try_to_lock);
    if (!lock) return failed(XRDS_ERROR_BUSY, "The upscaler is in use on another thread: create one for each thread.");
    xrds::Upscaler::Progress hear;
    if (progress) hear = [&](double share) { return progress(user, share) != 0; };
    return upscale(*found, required(colour, "colour"), frame, required(output, "output"), hear);
  });
}

// What `read` says of an open upscaler; zero of another or of one in use.
template <class Number>
Number ofUpscaler(const XrdsUpscaler* handle, Number (xrds::Upscaler::*read)() const) {
  Number number{};
  guarded([&] {
    if (const auto upscaler = Upscalers::open().find(handle))
      if (const std::unique_lock lock(upscaler->use, std::try_to_lock); lock) number = ((*upscaler->upscaler).*read)();
    return XRDS_OK;
  });
  return number;
}

}  // namespace

XrdsUpscalerOptions xrdsUpscalerOptionsDefault() { return {.structSize = sizeof(XrdsUpscalerOptions), .ensemble = 1}; }

XrdsResult xrdsCreateUpscaler(XrdsDevice* device, const XrdsModel* model, uint32_t width, uint32_t height,
                              const XrdsUpscalerOptions* options, XrdsUpscaler** upscaler) {
  return guarded([&] {
    XrdsUpscaler*& out = required(upscaler, "upscaler");
    const XrdsUpscalerOptions usual = xrdsUpscalerOptionsDefault();
    auto given = optionsOf(options ? taken(*options, usual) : usual);
    const auto on = Devices::open().opened(device, "device");
    if (on->preparation)
      given.onTuning = [&on](double share) {
        return on->preparation(on->preparationUser, 2, static_cast<size_t>(1000 * share), 1000) != 0;
      };
    const auto of = Models::open().opened(model, "model");
    out = Upscalers::open().add(std::make_shared<XrdsUpscaler>(on, of, width, height, given));
    return XRDS_OK;
  });
}

void xrdsDestroyUpscaler(XrdsUpscaler* upscaler) {
  guarded([&] {
    Upscalers::open().remove(upscaler);
    return XRDS_OK;
  });
}

XrdsResult xrdsUpscale(XrdsUpscaler* upscaler, const XrdsImage* colour, const XrdsImage* auxiliary,
                       uint32_t auxiliaryCount, const XrdsImage* output, XrdsProgress progress, void* user) {
  return upscaleGuarded(upscaler, colour, {auxiliary, auxiliaryCount}, output, progress, user);
}

XrdsResult xrdsUpscaleLayers(XrdsUpscaler* upscaler, const XrdsImage* colour, const XrdsImage* auxiliary,
                             uint32_t auxiliaryCount, const XrdsImage* output, const XrdsLayerSet* sets,
                             uint32_t setCount, XrdsLayerReport* reports, XrdsProgress progress, void* user) {
  return upscaleGuarded(upscaler, colour, {auxiliary, auxiliaryCount, sets, setCount, reports}, output, progress, user);
}

float xrdsGetExposure(const XrdsUpscaler* upscaler) { return ofUpscaler(upscaler, &xrds::Upscaler::exposure); }

uint64_t xrdsGetDeviceBytes(const XrdsUpscaler* upscaler) { return ofUpscaler(upscaler, &xrds::Upscaler::deviceBytes); }

XrdsImage xrdsInterleavedImage(void* pixels, XrdsFormat format, uint32_t channelCount, uint32_t width,
                               uint32_t height) {
  const ptrdiff_t number = format == XRDS_HALF ? 2 : 4, pixel = number * ptrdiff_t{channelCount};
  XrdsImage image{
      .pixelStride = pixel, .rowStride = pixel * ptrdiff_t{width}, .width = width, .height = height, .format = format};
  for (uint32_t c = 0; c < channelCount && c < 4 && pixels; ++c)
    image.channels[c] = static_cast<std::byte*>(pixels) + ptrdiff_t{c} * number;
  return image;
}
