#include <cstddef>
#include <limits>

#include "api/c/handles.h"
#include "api/c/images.h"
#include "api/c/layers.h"
#include "api/c/result.h"
#include "api/c/sized.h"

using namespace xrds::c;

xrds::DenoisingModels XrdsDenoisers::models() const {
  const auto modelOf = [](const std::shared_ptr<XrdsModel>& handle) { return handle ? &handle->model : nullptr; };
  return {modelOf(colour), modelOf(albedo), modelOf(normal)};
}

XrdsUpscaler::XrdsUpscaler(std::shared_ptr<XrdsDevice> on, std::shared_ptr<XrdsModel> of, XrdsDenoisers before,
                           uint32_t frameWidth, uint32_t frameHeight, const xrds::Upscaler::Options& options)
    : device(std::move(on)),
      model(std::move(of)),
      denoisers(std::move(before)),
      width(frameWidth),
      height(frameHeight),
      tiles(options.tiles) {
  const std::lock_guard lock(device->access);
  upscaler.emplace(device->gpu, model->model, xrds::FrameShape{height, width}, options, denoisers.models());
  note();
}

XrdsUpscaler::~XrdsUpscaler() {
  const std::lock_guard lock(device->access);
  alpha.reset();
  upscaler.reset();
}

void XrdsUpscaler::note() {
  exposure = upscaler->exposure();
  deviceBytes = upscaler->deviceBytes();
}

xrds::FrameUpscaler& XrdsUpscaler::alphaUpscaler() {
  if (!alpha) {
    alphaModel.emplace(xrds::untrainedModel(model->scale(), "bicubic", "none"));
    alpha.emplace(device->gpu, *alphaModel, xrds::FrameShape{height, width},
                  xrds::Upscaler::Options{.exposure = 1.F, .tiles = tiles});
  }
  return *alpha;
}

xrds::Upscaler::Options xrds::c::optionsOf(const XrdsUpscalerOptions* options) {
  const XrdsUpscalerOptions usual = xrdsUpscalerOptionsDefault(), given = options ? taken(*options, usual) : usual;
  // Headers without the field behind it had padding in the place of separateDenoisers.
  const bool separate =
      options && options->structSize > offsetof(XrdsUpscalerOptions, levelColour) && given.separateDenoisers;
  constexpr Upscaler::Tune kTunes[] = {Upscaler::Tune::automatic, Upscaler::Tune::never, Upscaler::Tune::now};
  if (const int tune = numberOf(given.tune); tune < XRDS_TUNE_AUTO || tune > XRDS_TUNE_NOW)
    throw InvalidArgument("The option tune is " + std::to_string(tune) +
                          ", expected XRDS_TUNE_AUTO, XRDS_TUNE_NEVER or XRDS_TUNE_NOW.");
  if (given.tileHalo > std::numeric_limits<uint32_t>::max())
    throw InvalidArgument("A tileHalo of " + std::to_string(given.tileHalo) + " pixels is larger than any frame.");
  Upscaler::Options asked{.fp16 = given.fp16 != 0,
                          .profile = given.profile != 0,
                          .ensemble = given.ensemble,
                          .tiles = {.memoryBytes = given.memoryBytes,
                                    .exact = given.exactTiles != 0,
                                    .wrap = given.wrap != 0,
                                    .columns = given.tileColumns,
                                    .rows = given.tileRows},
                          .skip = {.bound = given.skipBound, .keepUnchanged = given.keepUnchanged != 0},
                          .multiplyAddsPerSubmission = given.multiplyAddsPerSubmission,
                          .tune = kTunes[given.tune],
                          .denoisers = {.separate = separate, .level = given.levelColour != 0},
                          .denoisedColour = given.denoisedColour != 0};
  if (given.exposure != 0) asked.exposure = given.exposure;
  if (given.tileHalo >= 0) asked.tiles.halo = static_cast<uint32_t>(given.tileHalo);
  if (given.tuning)
    asked.onTuning = [hear = given.tuning, user = given.tuningUser](double share) { return hear(user, share) != 0; };
  return asked;
}

XrdsDenoisers xrds::c::denoisersOf(const XrdsUpscalerOptions* options) {
  if (!options) return {};
  const XrdsUpscalerOptions given = taken(*options, xrdsUpscalerOptionsDefault());
  const auto opened = [](const XrdsModel* model, const char* what) {
    return model ? Models::open().opened(model, what) : nullptr;
  };
  return {opened(given.denoiser, "denoiser"), opened(given.albedoDenoiser, "albedoDenoiser"),
          opened(given.normalDenoiser, "normalDenoiser")};
}

namespace {

void checkOutput(const XrdsUpscaler& upscaler, const XrdsImage& output) {
  checkImage(output, "output", 3);
  const uint32_t scale = upscaler.model->scale();
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
  writeChannel(output, 3, xrds::upscaledAlpha(upscaler.alphaUpscaler(), readChannel(colour, 3)).data(), 1);
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
  checkOutput(upscaler, output);
  const ReadImages images(upscaler.model->inputs(), colour, frame.auxiliary, frame.count);
  Layers layers(output);
  for (uint32_t i = 0; i < frame.setCount; ++i) {
    layers.add(at(frame.sets, i, "sets"));
    if (frame.reports) at(frame.reports, i, "reports");
  }
  const std::lock_guard lock(upscaler.device->access);
  if (!runInto(upscaler, images.colour, images.views, output, layers.sets(), progress))
    return failed(XRDS_CANCELLED, "The frame was cancelled.");
  writeAlpha(upscaler, colour, output);
  layers.write();
  for (uint32_t i = 0; frame.reports && i < frame.setCount; ++i) {
    const xrds::LayerReport& report = upscaler.upscaler->layerReports()[i];
    give<XrdsLayerReport>({sizeof(XrdsLayerReport), report.share, report.raisedColours, report.unshared},
                          at(frame.reports, i, "reports"));
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
    found->note();  // for who asks meanwhile
    return upscale(*found, required(colour, "colour"), frame, required(output, "output"), hear);
  });
}

// What `read` says of an open upscaler, `noted` of one in use; zero of another.
template <class Number>
Number ofUpscaler(const XrdsUpscaler* handle, Number (xrds::FrameUpscaler::*read)() const,
                  std::atomic<Number> XrdsUpscaler::*noted) {
  Number number{};
  guarded([&] {
    const auto upscaler = Upscalers::open().find(handle);
    if (!upscaler) return XRDS_OK;
    const std::unique_lock lock(upscaler->use, std::try_to_lock);
    number = lock ? ((*upscaler->upscaler).*read)() : ((*upscaler).*noted).load();
    return XRDS_OK;
  });
  return number;
}

}  // namespace

XrdsUpscalerOptions xrdsUpscalerOptionsDefault() {
  return {.structSize = sizeof(XrdsUpscalerOptions),
          .ensemble = 1,
          .multiplyAddsPerSubmission = xrds::Upscaler::Options{}.multiplyAddsPerSubmission,
          .tileHalo = -1};
}

XrdsResult xrdsCreateUpscaler(XrdsDevice* device, const XrdsModel* model, uint32_t width, uint32_t height,
                              const XrdsUpscalerOptions* options, XrdsUpscaler** upscaler) {
  return guarded([&] {
    XrdsUpscaler*& out = required(upscaler, "upscaler");
    auto given = optionsOf(options);
    const auto on = Devices::open().opened(device, "device");
    if (!given.onTuning && on->preparation)
      given.onTuning = [&on](double share) {
        return on->preparation(on->preparationUser, 2, static_cast<size_t>(1000 * share), 1000) != 0;
      };
    const auto of = Models::open().opened(model, "model");
    out = Upscalers::open().add(std::make_shared<XrdsUpscaler>(on, of, denoisersOf(options), width, height, given));
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

float xrdsGetExposure(const XrdsUpscaler* upscaler) {
  return ofUpscaler(upscaler, &xrds::FrameUpscaler::exposure, &XrdsUpscaler::exposure);
}

uint64_t xrdsGetDeviceBytes(const XrdsUpscaler* upscaler) {
  return ofUpscaler(upscaler, &xrds::FrameUpscaler::deviceBytes, &XrdsUpscaler::deviceBytes);
}

XrdsImage xrdsInterleavedImage(void* pixels, XrdsFormat format, uint32_t channelCount, uint32_t width,
                               uint32_t height) {
  const ptrdiff_t number = format == XRDS_HALF ? 2 : 4, pixel = number * ptrdiff_t{channelCount};
  XrdsImage image{
      .pixelStride = pixel, .rowStride = rowBytes(pixel, width), .width = width, .height = height, .format = format};
  for (uint32_t c = 0; c < channelCount && c < 4 && pixels; ++c)
    image.channels[c] = static_cast<std::byte*>(pixels) + ptrdiff_t{c} * number;
  return image;
}
