#include "api/denoising.h"

#include <algorithm>

#include "frames/denoised_runner.h"
#include "frames/too_little_memory.h"
#include "network/oidn.h"
#include "xrds/auxiliary_input.h"
#include "xrds/error.h"

namespace xrds {
namespace {

/// A network, the images that it is made ready for, and where it goes.
struct Stage {
  const NetworkModel& model;
  FrameShape shape;
  Upscaler::Options options;
  SessionOptions of;
  std::unique_ptr<FrameRunner>& runner;
  Tiling tiling{};
};

bool takes(const NetworkConfig& config, const AuxiliaryInput& input) { return config.auxOffset(input.name) >= 0; }

// All in the memory, each beside the weights of the others. Throws Error.
void tile(Gpu& gpu, std::vector<Stage>& stages, uint64_t memory) {
  uint64_t weights = 0;
  for (Stage& stage : stages) {
    stage.tiling = tilingIn(memory, gpu, stage.model, stage.shape, stage.options, stage.of);
    weights += stage.tiling.weightBytes;
  }
  for (Stage& stage : stages) {
    const uint64_t others = weights - stage.tiling.weightBytes;
    if (stage.tiling.arenaBytes + weights <= memory) continue;
    if (others >= memory)
      throw TooLittleMemory("The weights of the upscaler and its denoisers take more than the memory.");
    stage.tiling = tilingIn(memory - others, gpu, stage.model, stage.shape, stage.options, stage.of);
  }
}

// The largest arena first, in which the others go.
void open(Gpu& gpu, std::vector<Stage>& stages) {
  std::vector<Stage*> order;
  for (Stage& stage : stages) order.push_back(&stage);
  std::stable_sort(order.begin(), order.end(),
                   [](const Stage* a, const Stage* b) { return a->tiling.arenaBytes > b->tiling.arenaBytes; });
  const Session* lender = nullptr;
  for (Stage* const stage : order) {
    stage->of.lender = lender;
    stage->runner = runnerOf(gpu, stage->model, stage->shape, stage->options, stage->of, stage->tiling);
    if (!lender) lender = stage->runner->parts().front().session;
  }
}

}  // namespace

void checkDenoising(const NetworkConfig& upscaler, const DenoisingModels& models) {
  if (!models) return;
  const auto require = [](bool holds, const std::string& problem) {
    if (!holds) throw InvalidArgument(problem);
  };
  const auto isOf = [](const NetworkModel* model, const char* image) {
    return !model || denoisedImage(model->config()) == image;
  };
  require(models.colour, "A denoiser of albedo or normal was given without one of the colour.");
  require(isOf(models.colour, "hdr"), "The denoiser of the colour is no network of Open Image Denoise for HDR colour.");
  require(isOf(models.albedo, "albedo"), "The denoiser of the albedo is no network of Open Image Denoise for albedo.");
  require(isOf(models.normal, "normal"), "The denoiser of the normal is no network of Open Image Denoise for normals.");
  const auto& guides = models.colour->config().auxInputs;
  require((guides.empty() || takes(upscaler, kAlbedo)) && (guides.size() < 2 || takes(upscaler, kNormal)),
          "The denoiser of the colour takes an albedo or a normal that the model does not take.");
}

bool runsSeparately(const Upscaler::Options& options) {
  return options.denoisers.separate || options.ensemble > 1 || options.skip.bound > 0 || options.skip.keepUnchanged ||
         options.tiles.wrap;
}

void checkRoomForEach(const Gpu& gpu, const NetworkConfig& upscaler, FrameShape frame, const DenoisingModels& models,
                      const Upscaler::Options& options) {
  Upscaler::Options alone{.fp16 = options.fp16};
  alone.tiles = {.memoryBytes = options.tiles.memoryBytes, .exact = true};
  const auto check = [&](const NetworkModel* network, FrameShape shape) {
    if (network)
      tilingIn(memoryOf(gpu, alone.tiles), gpu, *network, shape, alone, sessionOptions(gpu, *network, shape, alone));
  };
  const FrameShape full{upscaler.scale * frame.height, upscaler.scale * frame.width};
  if (takes(upscaler, kAlbedo)) check(models.albedo, full);
  if (takes(upscaler, kNormal)) check(models.normal, full);
  check(models.colour, upscaler.radianceInputs().empty() ? frame : full);
}

DenoisedPlan planDenoised(Gpu& gpu, const NetworkModel& model, FrameShape frame, const DenoisingModels& denoising,
                          const Upscaler::Options& options, const SessionOptions& of, uint64_t memory) {
  const NetworkConfig& config = model.config();
  const uint64_t images = DenoisedRunner::imageBytes(frame, config.scale, config.auxInputs);
  if (images >= memory)
    throw TooLittleMemory("The images of a frame that is denoised first take more than the memory.");
  const FrameShape full{config.scale * frame.height, config.scale * frame.width};
  Upscaler::Options asked{.fp16 = options.fp16, .exposure = 1.F, .profile = options.profile};
  asked.tiles.exact = true;
  asked.multiplyAddsPerSubmission = options.multiplyAddsPerSubmission;
  DenoisedRunners runners;
  std::vector<Stage> stages;
  const auto add = [&](const NetworkModel* network, FrameShape shape, std::unique_ptr<FrameRunner>& runner) {
    if (network) stages.push_back({*network, shape, asked, sessionOptions(gpu, *network, shape, asked), runner});
  };
  add(takes(config, kAlbedo) ? denoising.albedo : nullptr, full, runners.albedo);
  add(takes(config, kNormal) ? denoising.normal : nullptr, full, runners.normal);
  add(config.radianceInputs().empty() ? nullptr : denoising.colour, full, runners.full);
  add(denoising.colour, frame, runners.low);
  stages.push_back({model, frame, options, of, runners.upscaler});
  runners.guides = static_cast<uint32_t>(denoising.colour->config().auxInputs.size());
  tile(gpu, stages, memory - images);
  open(gpu, stages);
  const Tiling tiling = stages.back().tiling;
  stages.clear();  // they refer to the runners
  return {std::make_unique<DenoisedRunner>(gpu, std::move(runners), frame, config.scale, config.auxInputs,
                                           options.exposure, of),
          tiling};
}

}  // namespace xrds
