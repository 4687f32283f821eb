#include "api/frame_upscaler.h"

#include <algorithm>
#include <exception>
#include <tuple>
#include <utility>

#include "api/arguments.h"
#include "api/colour.h"
#include "api/denoising.h"
#include "api/finite_image.h"
#include "api/layer_frame.h"
#include "api/model.h"
#include "api/separate_denoisers.h"
#include "checks/reference.h"
#include "frames/ensemble.h"
#include "frames/frame_exposure.h"
#include "frames/frame_runner.h"
#include "frames/quiet_windows.h"
#include "frames/tile_choice.h"
#include "network/oidn.h"
#include "xrds/auxiliary_input.h"
#include "xrds/noisy_share.h"

namespace xrds {
namespace {

FrameInput inputOf(const NetworkConfig& config, const PixelView& colour, std::span<const PixelView> auxiliary,
                   const Upscaler::Options& options) {
  FrameInput input{colour, {auxiliary.begin(), auxiliary.end()}, options.exposure};
  if (!input.exposure && takesBinnedExposure(config)) input.exposure = binnedExposure(colour);
  return input;
}

// Networks that denoise albedo or normals take these as their colour.
PixelKind kindOfColour(const NetworkConfig& config) {
  const std::string image = denoisedImage(config);
  return image == "albedo" || image == "normal" ? PixelKind::other : PixelKind::radiance;
}

PixelKind kindOf(const std::string& input) {
  const AuxiliaryInput* const kind = findAuxiliaryInput(input);
  return kind && kind->isRadiance ? PixelKind::radiance : PixelKind::other;
}

// The model as it runs: behind a denoiser, or on colours that were denoised, it may change a part of them alone.
NetworkModel modelFor(const NetworkModel& model, const DenoisingModels& denoising, const Upscaler::Options& options) {
  return denoising || options.denoisedColour ? model.behindDenoiser() : model;
}

}  // namespace

struct FrameUpscaler::State {
  State(Gpu& device, const NetworkModel& weights, FrameShape shape, const Options& given,
        const DenoisingModels& denoisers, uint32_t sharing = 1)
      : gpu(device),
        model(modelFor(weights, denoisers, given)),
        denoising(denoisers),
        config(model.config()),
        frame(shape),
        options(given),
        isSeparate(denoisers && runsSeparately(given)),
        sharers(sharing) {
    if (options.ensemble == 8 && frame.width != frame.height) {
      sharers = 2;
      Options once = options;
      once.ensemble = 1;
      turned =
          std::make_unique<State>(gpu, model, FrameShape{frame.width, frame.height}, once, DenoisingModels(), sharers);
    }
    prepareAsFits();
  }

  // Where the denoisers find no room in front, they need less one after the other.
  void prepareAsFits() {
    if (!denoising || denoisesSeparately()) return prepareInTiles();
    try {
      prepareInTiles();
    } catch (const DeviceLost&) {
      throw;
    } catch (const Cancelled&) {
      throw;
    } catch (const Error&) {
      noRoom = std::current_exception();
      isSeparate = true;
      runner.reset();
      prepareInTiles();
    }
  }

  void prepareInTiles() {
    try {
      prepare(memoryOf(gpu, options.tiles));
    } catch (const OutOfMemory&) {
      prepareSmaller(std::current_exception());
    }
  }

  void prepare(uint64_t memory) {
    SessionOptions of = sessionOptions(gpu, model, frame, options);
    of.memoryBytes = memory / sharers;
    of.layers = layerCount;
    if (denoising && !denoisesSeparately()) {
      tiling = {};  // where they do not fit, that of another plan is no measure of what may
      auto plan = planDenoised(gpu, model, frame, denoising, options, of, memory);
      tiling = plan.tiling;
      runner = std::move(plan.runner);
      return;
    }
    if (denoising) checkRoomForEach(gpu, config, frame, denoising, options);
    tiling = tilingIn(memory, gpu, model, frame, options, of, sharers);
    runner = runnerOf(gpu, model, frame, options, of, tiling);
  }

  // The device has less memory than it says, for other programs use it: tiles of half as much, again and again.
  void prepareSmaller(const std::exception_ptr& first) {
    while (true) {
      runner.reset();
      try {
        return prepare(sharers * (tiling.arenaBytes + tiling.weightBytes) / 2);
      } catch (const OutOfMemory&) {
      } catch (const Cancelled&) {
        throw;
      } catch (const Error&) {  // there are no smaller tiles
        std::rethrow_exception(first);
      }
    }
  }

  // Plans anew where the last plan was for another number of layers, or failed.
  void planLayers(uint32_t count, bool some) {
    if (turned) turned->planLayers(count, some);
    if (count == layerCount && some == hasLayers && runner) return;
    if (count > 0 && (options.skip.bound > 0 || options.skip.keepUnchanged))
      throw InvalidArgument(
          "Layers are made of every pixel of the frame: an upscaler that leaves out windows cannot make them.");
    if (hold.use_count() > 1)
      throw InvalidArgument(
          "The upscaler is part of a recording, which layers would change: destroy that, or create another "
          "upscaler.");
    runner.reset();
    isSeparate = denoising && runsSeparately(options);  // there may be room again
    noRoom = nullptr;
    if (!isSeparate && !some) networks.reset();
    layerCount = count;
    hasLayers = some;
    try {
      prepareAsFits();
    } catch (const Error&) {
      runner.reset();
      layerCount = 0;
      hasLayers = false;
      prepareAsFits();
      throw;
    }
  }

  bool runFinite(const PixelView& colour, std::span<const PixelView> auxiliary, std::vector<LayerImage> layers,
                 std::span<float> output, const Progress& progress) {
    FrameInput input = inputOf(config, colour, auxiliary, options);
    input.layers = std::move(layers);
    return runner->run(input, output, progress);
  }

  bool run(const PixelView& colour, std::span<const PixelView> auxiliary, const std::vector<LayerImage>& layers,
           std::span<float> output, const Progress& progress) {
    if (options.ensemble > 1) {
      if (!runEnsemble(colour, auxiliary, layers, output, progress)) return false;
    } else {
      if (!runFinite(colour, auxiliary, layers, output, progress)) return false;
      repairs.output = runner->lostPixels().size();
    }
    exposure = runner->exposure();
    return true;
  }

  bool runEnsemble(const PixelView& colour, std::span<const PixelView> auxiliary, const std::vector<LayerImage>& layers,
                   std::span<float> output, const Progress& progress) {
    const auto mirrors = mirrorsOf(options.ensemble);
    const uint32_t width = config.scale * frame.width, height = config.scale * frame.height;
    const double share = 1.0 / static_cast<double>(mirrors.size());
    EnsembleMean mean(width, height, config.transfer);
    std::vector<uint64_t> lost;
    for (const LayerImage& layer : layers) std::fill(layer.mean.begin(), layer.mean.end(), 0.F);
    for (size_t pass = 0; pass < mirrors.size(); ++pass) {
      const MirroredFrame images(colour, auxiliary, config.auxInputs, mirrors[pass]);
      MirroredLayers turnedLayers(layers, mirrors[pass], config.scale);
      State& state = turned && mirrors[pass].transposed ? *turned : *this;
      if (!state.runFinite(images.colour(), images.auxiliary(), turnedLayers.images(), output,
                           partOf(progress, static_cast<double>(pass) * share, share)))
        return false;
      mean.add(output, mirrors[pass], state.runner->exposure());
      turnedLayers.add(layers, static_cast<float>(share));
      const bool across = mirrors[pass].transposed;
      for (const uint64_t pixel : state.runner->lostPixels())
        lost.push_back(mirroredPixel(pixel, across ? height : width, across ? width : height, mirrors[pass]));
    }
    mean.write(output, runner->exposure());
    std::sort(lost.begin(), lost.end());
    repairs.output = static_cast<size_t>(std::unique(lost.begin(), lost.end()) - lost.begin());
    return true;
  }

  bool denoisesSeparately() const { return denoising && (isSeparate || hasLayers); }

  bool runImages(const FrameImages& images, std::span<float> output, const Progress& progress) {
    std::vector<LayerFrame> sets;
    sets.reserve(images.layers.size());
    std::vector<LayerImage> filtered;
    for (const LayerSet& set : images.layers) {
      const auto ofSet = sets.emplace_back(config, frame, set, images.colour, images.auxiliary).images();
      filtered.insert(filtered.end(), ofSet.begin(), ofSet.end());
    }
    if (!run(images.colour, images.auxiliary, filtered, output, progress)) return false;
    layerReports.clear();
    for (LayerFrame& set : sets) layerReports.push_back(set.share(output));
    for (size_t i = 0; i < images.shares.size(); ++i) layerReports[i].share = images.shares[i];
    return true;
  }

  // Where the device has no room for a network beside the upscaler, that goes and comes back.
  std::optional<FrameImages> denoised(const FrameImages& images, const Progress& progress) {
    const auto makeRoom = [&] {
      runner.reset();
      if (turned) turned->runner.reset();
    };
    auto clean = networks->denoised(images, progress, makeRoom);
    if (runner) return clean;
    networks->release();
    if (turned) turned->prepareAsFits();
    prepareAsFits();
    return clean;
  }

  // given: the images as they came, of which an ensemble of a model of the full-resolution colour makes a share.
  bool runDenoised(const FrameImages& given, const FrameImages& levelled, std::span<float> output,
                   const Progress& progress) {
    if (!networks) networks = std::make_unique<SeparateDenoisers>(gpu, config, denoising, options);
    const bool mixes = options.ensemble > 1 && config.auxOffset(kFullColour.name) >= 0 && given.layers.empty();
    const uint32_t before = networks->runs(levelled), own = options.ensemble;
    const double all = before + (mixes ? 2 : 1) * own;
    std::vector<float> noisy(mixes ? output.size() : 0);
    if (mixes) {
      const auto last = std::pair(exposure, repairs.output);
      if (!runImages(given, noisy, partOf(progress, 0, own / all))) return false;
      std::tie(exposure, repairs.output) = last;  // those of the last run, until this has its picture
    }
    const auto clean = denoised(levelled, partOf(progress, mixes ? own / all : 0, before / all));
    if (!clean || !runImages(*clean, output, partOf(progress, 1 - own / all, own / all))) return false;
    if (mixes) addNoisyShare(output, noisy, exposure);
    return true;
  }

  Gpu& gpu;
  const NetworkModel model;
  const DenoisingModels denoising;
  NetworkConfig config;
  FrameShape frame;
  Options options;
  bool isSeparate;                              // denoisers do not stand in front
  std::exception_ptr noRoom;                    // why not, where they should
  std::unique_ptr<SeparateDenoisers> networks;  // made when first needed
  uint32_t sharers;                             // of the memory: 2 with `turned`
  uint32_t layerCount = 0;                      // images beside the colour that the runner filters
  bool hasLayers = false;                       // denoisers then do not stand in front either
  const std::shared_ptr<const bool> hold = std::make_shared<bool>();  // shared with recordings, which use the runner
  std::vector<LayerReport> layerReports;                              // of the last run
  Tiling tiling;
  std::unique_ptr<FrameRunner> runner;  // null where the last plan failed
  std::unique_ptr<State> turned;        // an ensemble's, of frames that are not square, on their diagonal
  Upscaler::Repairs repairs{};
  float exposure = 0;  // of the last run
};

FrameUpscaler::FrameUpscaler(Gpu& gpu, const NetworkModel& model, FrameShape shape, const Options& options,
                             const DenoisingModels& denoising)
    : state_((checkOptions(options), checkShape(model.config(), shape), checkDenoising(model.config(), denoising),
              tuneIfAsked(gpu, model, shape, options), new State(gpu, model, shape, options, denoising))) {}
FrameUpscaler::~FrameUpscaler() = default;

bool paysToTune(const Gpu& gpu, const NetworkModel& model, FrameShape frame, bool fp16) {
  checkShape(model.config(), frame);
  return tuningPays(gpu, model, frame, fp16 ? Precision::fp16 : Precision::fp32);
}

bool FrameUpscaler::run(const PixelView& colour, std::span<const PixelView> auxiliary, std::span<float> output,
                        std::span<const LayerSet> layers, const Progress& progress) {
  checkImages(state_->config, state_->frame, colour, auxiliary);
  checkOutput(state_->config, state_->frame, output);
  uint32_t layerImages = 0;
  for (const LayerSet& set : layers) {
    checkLayers(state_->config, state_->frame, set);
    layerImages += layerImageCount(state_->config, set);
  }
  state_->planLayers(layerImages, state_->denoising && !layers.empty());
  const FiniteImage finiteColour(colour, kindOfColour(state_->config));
  std::vector<FiniteImage> finiteImages;
  FrameImages frame{finiteColour.view(), {}, {layers.begin(), layers.end()}};
  for (size_t i = 0; i < auxiliary.size(); ++i)
    finiteImages.emplace_back(auxiliary[i], kindOf(state_->config.auxInputs[i]));
  for (const FiniteImage& image : finiteImages) frame.auxiliary.push_back(image.view());
  FrameImages levelled = frame;
  std::vector<float> full;
  const bool levels = state_->denoising && state_->options.denoisers.level;
  if (const int first = state_->config.auxOffset(kFullColour.name); first >= 0 && levels) {
    PixelView& view = levelled.auxiliary[static_cast<size_t>(first) / 3];
    full = atLevelOf(view, frame.colour);
    view = {full.data(), view.width, view.height};
  }
  if (!(state_->denoisesSeparately() ? state_->runDenoised(frame, levelled, output, progress)
                                     : state_->runImages(levelled, output, progress)))
    return false;
  state_->repairs.colour = finiteColour.repaired();
  state_->repairs.auxiliary = 0;
  for (const FiniteImage& image : finiteImages) state_->repairs.auxiliary += image.repaired();
  return true;
}

const std::vector<LayerReport>& FrameUpscaler::layerReports() const { return state_->layerReports; }

Upscaler::Repairs FrameUpscaler::repairs() const { return state_->repairs; }

float FrameUpscaler::exposure() const { return state_->exposure; }

uint64_t FrameUpscaler::deviceBytes() const {
  const uint64_t own = state_->runner ? state_->runner->byteSize() : 0;
  const uint64_t ofDenoisers = state_->networks ? state_->networks->byteSize() : 0;
  return own + ofDenoisers + (state_->turned && state_->turned->runner ? state_->turned->runner->byteSize() : 0);
}

SkipMap FrameUpscaler::skipMap() const {
  const NetworkConfig& config = state_->config;
  const WindowMask none(state_->frame, config.window, false);
  SkipMap map{.side = config.window * config.scale, .columns = none.columns, .rows = none.rows};
  map.windows.resize(none.marks.size());
  const SparseRunner* const sparse = state_->runner ? state_->runner->sparse() : nullptr;
  map.work = sparse ? sparse->work() : state_->tiling.work;
  for (size_t i = 0; i < map.windows.size() && sparse; ++i) {
    if (sparse->interpolated().marks[i]) map.windows[i] = SkipMap::Window::interpolated;
    if (sparse->kept().marks[i]) map.windows[i] = SkipMap::Window::kept;
  }
  return map;
}

const Tiling& FrameUpscaler::tiling() const { return state_->tiling; }

std::vector<Upscaler::ProfileRow> FrameUpscaler::profile() const {
  std::vector<Upscaler::ProfileRow> rows, own;
  if (state_->runner) own = profileRows(state_->runner->times());
  if (state_->networks && !own.empty()) rows = state_->networks->profile();
  rows.insert(rows.end(), own.begin(), own.end());
  return rows;
}

std::vector<Upscaler::CheckRow> checkFrame(Gpu& gpu, const NetworkModel& model, const PixelView& colour,
                                           std::span<const PixelView> auxiliary, const Upscaler::Options& options,
                                           const DenoisingModels& denoising) {
  const FrameShape frame{colour.height, colour.width};
  checkOptions(options);
  checkShape(model.config(), frame);
  checkDenoising(model.config(), denoising);
  checkImages(model.config(), frame, colour, auxiliary);
  const CheckResult result = checkAgainstReference(gpu, modelFor(model, denoising, options), frame,
                                                   inputOf(model.config(), colour, auxiliary, options),
                                                   sessionOptions(gpu, model, frame, options));
  std::vector<Upscaler::CheckRow> rows;
  for (const Divergence& node : result.nodes)
    rows.push_back({node.node, node.relativeRms, node.finite, node.finite && node.relativeRms <= result.bound});
  return rows;
}

Gpu& FrameUpscaler::gpu() const { return state_->gpu; }
const Upscaler::Options& FrameUpscaler::options() const { return state_->options; }
const NetworkConfig& FrameUpscaler::config() const { return state_->config; }
FrameShape FrameUpscaler::shape() const { return state_->frame; }

std::vector<FramePart> FrameUpscaler::parts() const {
  if (state_->options.ensemble > 1)
    throw InvalidArgument("An ensemble of " + std::to_string(state_->options.ensemble) +
                          " passes cannot be recorded: create the upscaler with an ensemble of 1.");
  state_->planLayers(0, false);  // the run before may have had some
  if (state_->noRoom) std::rethrow_exception(state_->noRoom);
  if (state_->denoising && (state_->isSeparate || state_->options.denoisers.level))
    throw InvalidArgument(
        "Denoisers that run one after the other, or bring a colour to the level of another one, cannot be recorded: "
        "create the upscaler without skipBound, keepUnchanged, wrap, separateDenoisers and levelColour.");
  auto parts = state_->runner->parts();
  if (parts.empty())
    throw InvalidArgument(
        "An upscaler that leaves out windows cannot be recorded, as their pixels decide: create it without skipBound "
        "and keepUnchanged.");
  return parts;
}

std::shared_ptr<const void> FrameUpscaler::hold() const { return state_->hold; }

const DenoisingParts* FrameUpscaler::denoising() const { return state_->runner->denoising(); }

}  // namespace xrds
