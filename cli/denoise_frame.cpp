#include "cli/denoise_frame.h"

#include "app/byte_count.h"
#include "app/network_options.h"
#include "cli/progress.h"
#include "image/layers/aov.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

std::vector<std::string> inputsOf(const DenoiseOptions& options, const std::string& color, const std::string& aux) {
  if (options.guides == "none") return {};
  const ExrFile file = readExrHeader(pathOf(aux.empty() ? color : aux));
  const auto isThere = [&](AovRole role) { return !options.common.layers.nameOf(role).empty() || hasAov(file, role); };
  std::vector<std::string> inputs;
  if (isThere(AovRole::kAlbedo)) inputs.emplace_back(kAlbedo.name);
  if (!inputs.empty() && isThere(AovRole::kNormal)) inputs.emplace_back(kNormal.name);
  if (inputs.empty() && !aux.empty())
    throw Error("'" + aux + "' holds no albedo: name its layer with --albedo, or denoise the colour alone.");
  return inputs;
}

}  // namespace

Frame openFrame(const DenoiseOptions& options, const std::string& color, const std::string& aux) {
  Frame frame(pathOf(color), pathOf(aux), options.common.layers, inputsOf(options, color, aux), {.never = true});
  if (frame.inputs().empty() && options.guides != "none" && hasAov(frame.auxiliaryFile(), AovRole::kNormal))
    frame.warn(
        "There is no albedo of a known name, without which the normal is not used: name its layer with --albedo.");
  if (frame.scale() > 1)
    throw Error("Albedo and normal have " + std::to_string(frame.scale()) +
                " times the colour's size: a denoiser takes images of one size; xrds upscale is for these.");
  return frame;
}

NetworkDenoiser::Options networksOf(const DenoiseOptions& options, const std::function<bool(double)>& progress) {
  using Quality = NetworkDenoiser::Quality;
  return {.folder = pathOf(options.common.denoisers),
          .quality = options.quality == "high"   ? Quality::high
                     : options.quality == "fast" ? Quality::fast
                                                 : Quality::balanced,
          .ldr = options.ldr,
          .exposure = parseExposure(options.common.exposure),
          .fp16 = options.common.precision == kFp16,
          .memoryBytes = parseBytes(options.common.memory),
          .progress = progress,
          .staysPrepared = options.common.memory.empty() && !options.common.lights.empty()};
}

bool areClean(const DenoiseOptions& options) { return options.guides == "clean"; }

bool arePrefiltered(const DenoiseOptions& options, size_t guides) {
  return options.guides == "prefilter" && guides > 0;
}

Denoised denoised(NetworkDenoiser& networks, Device& device, const Frame& frame, const DenoiseOptions& options) {
  const auto& images = frame.auxiliary();
  const bool prefilters = arePrefiltered(options, images.size()), clean = areClean(options) || prefilters;
  const Image *albedo = images.empty() ? nullptr : &images[0], *normal = images.size() < 2 ? nullptr : &images[1];
  Image cleanAlbedo, cleanNormal;
  return untilInterrupted([&]() -> Denoised {
    if (prefilters) {
      cleanAlbedo = networks.denoisedAlbedo(device, *albedo);
      albedo = &cleanAlbedo;
    }
    if (prefilters && normal) {
      cleanNormal = networks.denoisedNormal(device, *normal);
      normal = &cleanNormal;
    }
    if (!frame.layers()) return {networks.denoised(device, frame.colour(), albedo, normal, clean)};
    FrameLayers layers = *frame.layers();
    DeviceDenoiser single(networks, device, clean);
    if (prefilters) layers.denoiseColours(single);
    layers.denoise(single, albedo, normal);
    UpscaledLayers room = layers.room(1);
    Image picture = networks.denoised(device, frame.colour(), albedo, normal, clean, layers.sets(room));
    room.reports = layers.reports(networks.layerReports());
    return {std::move(picture), std::move(room)};
  });
}

size_t runsFor(const Frame& frame, const DenoiseOptions& options) {
  const bool prefilters = arePrefiltered(options, frame.auxiliary().size());
  const size_t ofLayers =
      frame.layers() ? frame.layers()->noisyImages() + (prefilters ? frame.layers()->noisyColours() : 0) : 0;
  return 1 + (prefilters ? frame.auxiliary().size() : 0) + ofLayers;
}

ExrOutput outputOf(const DenoiseOptions& options, const Frame& frame, const std::string& denoiser) {
  ExrOutput output = frame.output(1);
  output.texts["xrds:version"] = XRDS_VERSION;
  output.texts["xrds:denoiser"] = denoiser;
  output.texts["xrds:options"] = "guides=" + options.guides + " precision=" + options.common.precision;
  output.pixelType = options.common.half ? ExrPixelType::kHalf : ExrPixelType::kFloat;
  return output;
}

}  // namespace xrds
