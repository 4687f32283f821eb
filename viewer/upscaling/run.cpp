// How a frame goes through the network and becomes pictures.
#include <utility>

#include "app/constant_input.h"
#include "app/failing_with.h"
#include "app/models.h"
#include "viewer/upscaling/upscaling.h"
#include "xrds/path_text.h"

namespace xrds {
namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kTilePeriod = std::chrono::milliseconds(200);

// From so much work on, a second or more on a CPU, the guided image is shown first.
constexpr uint64_t kWorkWorthABase = uint64_t{1} << 36;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

const char* baseName(Slot slot) {
  return slot == Slot::bicubic ? "bicubic" : slot == Slot::demodulated ? "demodulated" : "guided";
}

}  // namespace

// As `xrds upscale` chooses it.
std::string Upscaling::wantedModel(const Wanted& wanted) const {
  if (!wanted.model.empty()) return wanted.model;
  if (live_) return liveModelName();
  if (std::string model = modelWithoutConstant(wanted); !model.empty()) return model;
  std::vector<std::string> inputs = size_.inputs;
  std::optional<double> samples = frame_->samples;
  if (wanted.skip.bound() > 0) {  // models of few samples, and those of a full-resolution colour, cannot skip
    std::erase(inputs, kFullColour.name);
    samples.reset();
  }
  return failingWith(ExitCode::model, [&] { return defaultModel(size_.scale, inputs, samples); }).stem().string();
}

// Of a frame whose albedo or normal is the same everywhere; empty: none is shipped, or one was asked for.
std::string Upscaling::modelWithoutConstant(const Wanted& wanted) const {
  if (live_ || !wanted.model.empty() || frame_->constant.empty() || !size_.has(std::string(kAlbedo.name))) return "";
  return modelWithout(frame_->constant, size_.scale).stem().string();
}

// Skipping needs the frame on the host; without it nothing leaves the device. What stays as it was is looked for where
// frames follow each other; in a live view every sample changes every pixel but those that are skipped anyway.
NetworkOptions Upscaling::optionsFor(const Wanted& wanted, const Model& model) {
  NetworkOptions options{.fp16 = wanted.fp16,
                         .exposure = wanted.exposure,
                         .ensemble = wanted.ensemble,
                         .wrap = wanted.wrap,
                         .exactTiles = wanted.exactTiles,
                         .memoryBytes = wanted.memoryBytes,
                         .tune = wanted.tune,
                         .multiplyAddsAtOnce = pace_};
  if (wanted.denoiseFirst) {
    const bool hasAlbedo = takes(model, kAlbedo), hasNormal = takes(model, kNormal);
    const bool clean = live_ || wanted.cleanGuides;
    options.denoisers = failingWith(ExitCode::model, [&] { return denoisers_.inFront(hasAlbedo, hasNormal, clean); });
    options.denoisers.level = wanted.ensemble > 1;  // which takes a full-resolution colour as it is, too
  }
  if (wanted.skip.bound() == 0 || wanted.wrap || !model.whyNeverSkipped().empty()) return options;
  const bool mayKeep = !live_ && wanted.ensemble == 1 && (wanted.watching || wanted.sequence);
  options.skip = {.bound = wanted.skip.bound(), .keepUnchanged = mayKeep};
  return options;
}

void Upscaling::prepare(const Wanted& wanted) {
  const std::string name = wantedModel(wanted);
  const bool same = network_ && network_->name() == name;
  const bool upscaled = std::exchange(upscaled_, false);  // an error that is thrown here goes with the next picture
  if (same && network_->options() == optionsFor(wanted, network_->model()) && network_->fits(size_)) {
    upscaled_ = upscaled;
    return;
  }
  tell([&](Report& report) { report.waiting = "Preparing the network " + pathOf(name).stem().string() + " ..."; });
  network_.reset();  // its memory goes before the next one's comes
  flicker_.reset();
  pictures_.invalidate(Slot::skipMap);
  if (!bases_.empty() && !bases_.begin()->second->fits(size_)) bases_.clear();
  Model model = failingWith(ExitCode::model, [&] { return Model(resolveModel(name)); });
  NetworkOptions options = optionsFor(wanted, model);
  options.onTuning = [this](double share) {
    const auto percent = std::to_string(static_cast<int>(100 * share));
    tell([&](Report& report) { report.waiting = "Finding the fastest kernels of this device: " + percent + " %"; });
    return !outdated();
  };
  network_ = std::make_unique<PreparedNetwork>(vulkan_, device_, name, std::move(model), size_, options);
  clock_.end("preparing");
}

// Returns how many frames they are made of.
size_t Upscaling::giveInputs(PreparedNetwork& network) {
  if (live_) return live_->giveTo(network) ? 2 : 1;
  network.take(*frame_);
  return frame_->merged;
}

// Cuts the work as this device needs it: on a fast one small submissions take longer to make than to run.
void Upscaling::keepPace() {
  if (network_->options().multiplyAddsAtOnce == pace_) return;
  const std::string name = network_->name();
  NetworkOptions options = network_->options();
  options.multiplyAddsAtOnce = pace_;
  network_.reset();
  network_ = std::make_unique<PreparedNetwork>(vulkan_, device_, name, Model(resolveModel(name)), size_, options);
  clock_.end("preparing");
}

// Something to look at while a large network computes.
void Upscaling::showBaseFirst() {
  const PictureView output = pictures_.at(Slot::output);
  if (live_ || output.valid || pictures_.at(Slot::guided).valid) return;
  const uint32_t scale = network_->model().scale();
  const Model::Cost cost = network_->model().cost(scale * size_.width, scale * size_.height, network_->options().fp16,
                                                  device_.description().kernelFamily);
  if (cost.multiplyAdds < kWorkWorthABase) return;
  makeBase(Slot::guided);
  clock_.end("guided image first");
}

// Of a run that is under way; returns whether it shall go on. Tiles are shown as they are finished.
bool Upscaling::showProgress(double share) {
  const auto finished = static_cast<uint32_t>(share * network_->tileCount());
  // Those of several passes are mirrored until their mean is there.
  if (network_->options().ensemble == 1 && finished > tilesShown_ && Clock::now() - lastShown_ > kTilePeriod) {
    tilesShown_ = finished;
    network_->showOutput(pictures_, Slot::output);
    lastShown_ = Clock::now();
    tell([](Report& report) { ++report.partialPictures; });
  }
  const std::lock_guard lock(mutex_);
  report_.share = share;
  const bool hardlyLost = live_ || (share > 0.5 && network_->tileCount() == 1);
  return !stopping_ && (asked_ == serving_ || hardlyLost);
}

void Upscaling::upscale(const Wanted& wanted) {
  keepPace();
  const std::string without = modelWithoutConstant(wanted);
  const auto begin = [&](Report& report) {
    report.width = size_.width;
    report.height = size_.height;
    report.scale = network_->model().scale();
    report.hasReference = frame_ && frame_->reference;
    report.files = live_ ? "live" : frame_->files.colour.filename().string();
    report.warnings = live_ ? std::vector<std::string>{} : frame_->warnings;
    if (!without.empty()) report.warnings.push_back(tellConstant(frame_->constant, without));
    report.error.clear();
    report.failure = ExitCode::ok;
    report.waiting.clear();
    report.compared.clear();
    report.share = 0;
    report.tiles = network_->tileCount();
    report.onDevice = network_->isOnDevice();
    report.whyNotSkipped = wanted.skip.bound() == 0 ? ""
                           : wanted.wrap            ? "computes a panorama in full"
                                                    : network_->model().whyNeverSkipped();
  };
  {
    const std::lock_guard lock(mutex_);
    begin(report_);
  }
  const size_t merged = giveInputs(*network_);
  if (live_ && merged > 1) clock_.end("merging");
  network_->showInputs(pictures_);
  if (!live_) changed_();  // a live view is drawn once for each picture
  clock_.end("copies");
  showBaseFirst();
  tilesShown_ = 0;
  const auto running = Clock::now();
  if (!network_->run([this](double share) { return showProgress(share); })) return;
  const uint64_t pace = network_->paceFor(millisecondsSince(running));
  clock_.end(kNetworkStage);
  // Submissions of another size run at another speed themselves: only what is far off is worth a network made anew.
  constexpr uint64_t kFarOff = 5;
  if (pace > kFarOff * pace_ || kFarOff * pace < pace_) pace_ = pace;
  network_->showOutput(pictures_, Slot::output);
  network_->showSkipMap(pictures_);
  showFlicker(wanted);
  upscaled_ = true;
  measured_ = false;
  clock_.end("copies");
  tellPicture(merged);
}

void Upscaling::showFlicker(const Wanted& wanted) {
  const PictureView output = pictures_.at(Slot::output);
  const bool wants = wanted.slots[static_cast<size_t>(Slot::flicker)];
  if (!wants) flicker_.reset();
  if (!flicker_ || !flicker_->fits(output)) pictures_.invalidate(Slot::flicker);
  if (!wants) return;
  if (!flicker_ || !flicker_->fits(output)) flicker_ = std::make_unique<Flicker>(vulkan_, output.width, output.height);
  flicker_->add(pictures_);
}

void Upscaling::tellPicture(size_t merged) {
  std::vector<StageTime> stages = stageTimes(clock_.steps(), network_->profile());
  const double period = millisecondsSince(lastPicture_) / 1000;
  lastPicture_ = Clock::now();
  tell([&](Report& report) {
    report.model = network_->name();
    report.samples = live_ ? live_->samples() : 0;
    report.merged = merged;
    report.fp16 = network_->options().fp16;
    report.denoisedBy = network_->options().denoisers.colour ? denoisers_.name() : "";
    const SkipMap map = network_->upscaler().skipMap();
    report.interpolated = map.share(SkipMap::Window::interpolated);
    report.kept = map.share(SkipMap::Window::kept);
    report.windowSide = map.side;
    report.exposure = network_->exposure();
    report.deviceBytes = network_->deviceBytes() + pictures_.byteSize();
    report.stages = std::move(stages);
    const double rate = period > 0 ? 1 / period : 0;
    report.picturesPerSecond = period > 2 ? rate : 0.7 * report.picturesPerSecond + 0.3 * rate;
    report.share = 1;
    ++report.pictures;
  });
}

void Upscaling::makeBase(Slot slot) {
  std::unique_ptr<PreparedNetwork>& base = bases_[slot];
  const auto scale = network_->model().scale();
  const NetworkOptions options{.memoryBytes = network_->options().memoryBytes, .multiplyAddsAtOnce = pace_};
  if (!base || !base->fits(size_) || base->model().scale() != scale || base->options() != options) {
    Model model = Model::untrained(scale, baseName(slot));
    for (const std::string& input : model.auxiliaryInputs())
      if (!size_.has(input)) return;
    base = std::make_unique<PreparedNetwork>(vulkan_, device_, baseName(slot), std::move(model), size_, options);
  }
  giveInputs(*base);
  if (!base->run([&](double) { return !stopping(); })) return;
  base->showOutput(pictures_, slot);
  measured_ = false;
  changed_();
}

}  // namespace xrds
