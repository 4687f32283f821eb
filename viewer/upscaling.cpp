#include "viewer/upscaling.h"

#include <algorithm>
#include <utility>

#include "app/models.h"
#include "viewer/stage_times.h"
#include "xrds/error.h"

namespace xrds {
namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kPollPeriod = std::chrono::milliseconds(50);
constexpr auto kTilePeriod = std::chrono::milliseconds(200);

// From so much work on, a second or more on a CPU, the guided image is shown first.
constexpr uint64_t kWorkWorthABase = uint64_t{1} << 36;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

const char* baseName(Slot slot) {
  return slot == Slot::bicubic ? "bicubic" : slot == Slot::demodulated ? "demodulated" : "guided";
}

std::vector<fs::path> filesOf(const FrameFiles& files) {
  std::vector<fs::path> paths{files.colour};
  for (const fs::path& path : {files.auxiliary, files.reference})
    if (!path.empty()) paths.push_back(path);
  return paths;
}

bool samePixels(const AovRequest& a, const AovRequest& b) {
  return a.color == b.color && a.albedo == b.albedo && a.normal == b.normal && a.depth == b.depth;
}

}  // namespace

bool Wanted::operator==(const Wanted& other) const {
  return files == other.files && watching == other.watching && inSequence == other.inSequence &&
         folder == other.folder && samePixels(layers, other.layers) && live == other.live && model == other.model &&
         fp16 == other.fp16 && skip.bound() == other.skip.bound() && memoryBytes == other.memoryBytes &&
         slots == other.slots && metrics == other.metrics && reload == other.reload;
}

Upscaling::Upscaling(Device& device, Pictures& pictures, std::function<void()> changed)
    : device_(device), pictures_(pictures), changed_(std::move(changed)) {
  report_.device = device.description().name;
  report_.settled = true;
  thread_ = std::thread([this] { loop(); });
}

Upscaling::~Upscaling() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Upscaling::want(const Wanted& wanted) {
  {
    const std::lock_guard lock(mutex_);
    if (wanted == wanted_) return;
    wanted_ = wanted;
    report_.settled = false;
    ++asked_;
  }
  wake_.notify_all();
}

void Upscaling::save(const fs::path& path) {
  {
    const std::lock_guard lock(mutex_);
    saveTo_ = path;
    report_.settled = false;
  }
  wake_.notify_all();
}

Report Upscaling::report() const {
  const std::lock_guard lock(mutex_);
  return report_;
}

void Upscaling::fail(const std::string& error) {
  tell([&](Report& report) { report.error = error; });
}

void Upscaling::tell(const std::function<void(Report&)>& change) {
  {
    const std::lock_guard lock(mutex_);
    change(report_);
  }
  changed_();
}

bool Upscaling::stopping() const {
  const std::lock_guard lock(mutex_);
  return stopping_;
}

bool Upscaling::outdated() const {
  const std::lock_guard lock(mutex_);
  return stopping_ || asked_ != serving_;
}

void Upscaling::loop() {
  for (;;) {
    Wanted wanted;
    {
      std::unique_lock lock(mutex_);
      const auto woken = [&] { return stopping_ || refining_ || asked_ != serving_ || !saveTo_.empty(); };
      if (wanted_.watching || measuring_.valid())
        wake_.wait_for(lock, kPollPeriod, woken);
      else
        wake_.wait(lock, woken);
      if (stopping_) return;
      serving_ = asked_;
      wanted = wanted_;
    }
    try {
      serve(wanted);
    } catch (const std::exception& failure) {
      const std::string text = failure.what();
      refining_ = false;
      // A file that is being written cannot be read; the next look at it may find it whole.
      const auto place = wanted.watching ? &Report::waiting : &Report::error;
      if (report().*place == text && report().settled) continue;
      tell([&](Report& report) {
        report.*place = text;
        report.share = 1;
        report.settled = asked_ == serving_;
      });
    }
  }
}

void Upscaling::serve(const Wanted& wanted) {
  takeMetrics();
  if (!wanted.live.scene.empty()) {
    trace(wanted);
  } else if (!wanted.files.colour.empty() || !wanted.folder.empty()) {
    live_.reset();
    refining_ = false;
    if (loadWanted(wanted)) upscaled_ = false;
    if (frame_) showChosen(wanted);
    if (outdated()) return;
  }
  saveIfAsked();
  const std::lock_guard lock(mutex_);
  const bool settled = asked_ == serving_ && saveTo_.empty() && !measuring_.valid() && !refining_;
  if (report_.settled == settled) return;
  report_.settled = settled;
  changed_();
}

void Upscaling::showChosen(const Wanted& wanted) {
  prepare(wanted);
  if (!upscaled_) upscale();
  if (!upscaled_ || outdated()) return;
  for (const Slot slot : {Slot::bicubic, Slot::demodulated, Slot::guided})
    if (wanted.slots[static_cast<size_t>(slot)] && (live_ || !pictures_.at(slot).valid)) makeBase(slot);
  if (wanted.metrics && frame_) startMetrics();
}

// One step of the live view: more samples, then the picture that they make.
void Upscaling::trace(const Wanted& wanted) {
  constexpr uint32_t kScale = 4;  // of the networks that are fast enough
  if (!live_ || !live_->isOf(wanted.live, kScale)) {
    tell([&](Report& report) { report.waiting = "preparing " + wanted.live.scene; });
    live_.reset();
    frame_.reset();
    live_ = std::make_unique<LiveScene>(EngineAccess::gpu(device_), wanted.live, kScale);
    size_ = {wanted.live.width, wanted.live.height, kScale, {"albedo", "normal"}};
    upscaled_ = false;
    for (const Slot slot : {Slot::output, Slot::bicubic, Slot::demodulated, Slot::guided, Slot::reference})
      pictures_.invalidate(slot);
    tell([&](Report& report) {
      report.scene = wanted.live.scene;
      report.startCamera = live_->start();
    });
  }
  live_->look(wanted.live.camera);
  const auto start = Clock::now();
  if (!live_->finished(wanted.live)) {
    upscaled_ = false;
    if (!live_->refine(wanted.live, [&](size_t, size_t) { return !stopping(); })) return;
    loadStages_ = {{"path tracing", millisecondsSince(start)}};
  }
  refining_ = !live_->finished(wanted.live);
  showChosen(wanted);
}

// Returns whether there is a new frame.
bool Upscaling::loadWanted(const Wanted& wanted) {
  FrameFiles files = wanted.files;
  if (!wanted.folder.empty()) files = newestFrame(wanted.folder);
  const bool same =
      frame_ && files == frame_->files && samePixels(wanted.layers, served_.layers) && wanted.reload == served_.reload;
  if (wanted.watching) {
    if (std::exchange(served_.reload, wanted.reload) != wanted.reload) watch_.forget();
    if (!watch_.changed(filesOf(files), Clock::now())) return false;
  } else if (same) {
    return false;
  }
  const auto start = Clock::now();
  LoadedFrame loaded = loadFrame(files, wanted.layers);
  served_ = wanted;
  loadStages_ = {{"read files", millisecondsSince(start)}};
  takeFrame(std::move(loaded));
  return true;
}

void Upscaling::takeFrame(LoadedFrame frame) {
  frame_ = std::move(frame);
  size_ = {static_cast<uint32_t>(frame_->colour.width), static_cast<uint32_t>(frame_->colour.height), frame_->scale,
           frame_->inputs};
  ++frameCount_;
  measured_ = false;
  for (const Slot slot : {Slot::output, Slot::bicubic, Slot::demodulated, Slot::guided}) {
    const PictureView now = pictures_.at(slot);
    const bool fits = now.width % static_cast<uint32_t>(frame_->colour.width) == 0 &&
                      now.height % static_cast<uint32_t>(frame_->colour.height) == 0;
    // The last output stays in sight until the next one replaces it, unless it has another size.
    if (slot != Slot::output || !fits) pictures_.invalidate(slot);
  }
  if (!frame_->reference) return pictures_.invalidate(Slot::reference);
  const Image& reference = *frame_->reference;
  std::vector<float> pixels(reference.pixelCount() * 4);
  for (size_t p = 0; p < reference.pixelCount(); ++p)
    std::copy_n(&reference.pixels[p * static_cast<size_t>(reference.channels)], 3, &pixels[4 * p]);
  pictures_.upload(Slot::reference, static_cast<uint32_t>(reference.width), static_cast<uint32_t>(reference.height), 4,
                   pixels);
}

std::string Upscaling::wantedModel(const Wanted& wanted) const {
  if (!wanted.model.empty()) return wanted.model;
  if (live_) return "xrds-x4-mini";
  if (size_.inputs.empty()) return "xrds-x4-compact-plain";
  return defaultModel(size_.scale, size_.has("normal")).stem().string();
}

// Skipping needs the frame on the host; without it nothing leaves the device. What stays as it was is looked for where
// frames follow each other; in a live view every sample changes every pixel but those that are skipped anyway.
NetworkOptions Upscaling::optionsFor(const Wanted& wanted, const Model& model) const {
  NetworkOptions options{.fp16 = wanted.fp16, .memoryBytes = wanted.memoryBytes, .multiplyAddsAtOnce = pace_};
  if (wanted.skip.bound() == 0 || !model.whyNeverSkipped().empty()) return options;
  options.skip = {.bound = wanted.skip.bound(), .keepUnchanged = !live_ && (wanted.watching || wanted.inSequence)};
  return options;
}

void Upscaling::prepare(const Wanted& wanted) {
  const std::string name = wantedModel(wanted);
  const bool same = network_ && network_->name() == name;
  if (same && network_->options() == optionsFor(wanted, network_->model()) && network_->fits(size_)) return;
  upscaled_ = false;
  tell([&](Report& report) { report.waiting = "preparing " + fs::path(name).stem().string(); });
  network_.reset();  // its memory goes before the next one's comes
  pictures_.invalidate(Slot::skipMap);
  if (!bases_.empty() && !bases_.begin()->second->fits(size_)) bases_.clear();
  Model model(resolveModel(name));
  const NetworkOptions options = optionsFor(wanted, model);
  network_ = std::make_unique<PreparedNetwork>(device_, name, std::move(model), size_, options);
}

void Upscaling::giveInputs(PreparedNetwork& network) {
  if (live_)
    live_->giveTo(network);
  else
    network.take(*frame_);
}

// Cuts the work as this device needs it: on a fast one small submissions take longer to make than to run.
void Upscaling::keepPace() {
  if (network_->options().multiplyAddsAtOnce == pace_) return;
  const std::string name = network_->name();
  NetworkOptions options = network_->options();
  options.multiplyAddsAtOnce = pace_;
  network_.reset();
  network_ = std::make_unique<PreparedNetwork>(device_, name, Model(resolveModel(name)), size_, options);
}

// Something to look at while a large network computes.
void Upscaling::showBaseFirst() {
  const PictureView output = pictures_.at(Slot::output);
  if (live_ || output.valid || pictures_.at(Slot::guided).valid) return;
  const uint32_t scale = network_->model().scale();
  const Model::Cost cost = network_->model().cost(scale * size_.width, scale * size_.height, network_->options().fp16,
                                                  device_.description().kernelFamily);
  if (cost.multiplyAdds >= kWorkWorthABase) makeBase(Slot::guided);
}

// Of a run that is under way; returns whether it shall go on. Tiles are shown as they are finished.
bool Upscaling::showProgress(double share) {
  const auto finished = static_cast<uint32_t>(share * network_->tileCount());
  if (finished > tilesShown_ && Clock::now() - lastShown_ > kTilePeriod) {
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

void Upscaling::upscale() {
  keepPace();
  const auto start = Clock::now();
  const auto begin = [&](Report& report) {
    report.width = size_.width;
    report.height = size_.height;
    report.scale = network_->model().scale();
    report.hasReference = frame_ && frame_->reference;
    report.files = live_ ? "live" : frame_->files.colour.filename().string();
    report.warnings = live_ ? std::vector<std::string>{} : frame_->warnings;
    report.samples = live_ ? live_->samples() : 0;
    report.error.clear();
    report.waiting.clear();
    report.compared.clear();
    report.share = 0;
    report.tiles = network_->tileCount();
    report.onDevice = network_->isOnDevice();
    report.whyNotSkipped = wanted_.skip.bound() > 0 ? network_->model().whyNeverSkipped() : "";
  };
  {
    const std::lock_guard lock(mutex_);
    begin(report_);
  }
  giveInputs(*network_);
  network_->showInputs(pictures_);
  if (!live_) changed_();  // a live view is drawn once for each picture
  showBaseFirst();
  tilesShown_ = 0;
  const auto running = Clock::now();
  if (!network_->run([this](double share) { return showProgress(share); })) return;
  const uint64_t pace = network_->paceFor(millisecondsSince(running));
  if (pace > 3 * pace_ || 3 * pace < pace_) pace_ = pace;
  network_->showOutput(pictures_, Slot::output);
  network_->showSkipMap(pictures_);
  upscaled_ = true;
  measured_ = false;
  tellPicture(millisecondsSince(start));
}

void Upscaling::tellPicture(double networkMilliseconds) {
  std::vector<StageTime> stages = loadStages_;
  stages.push_back({"network, all", networkMilliseconds});
  for (StageTime& stage : stageTimes(network_->upscaler().profile())) stages.push_back(std::move(stage));
  const double period = millisecondsSince(lastPicture_) / 1000;
  lastPicture_ = Clock::now();
  tell([&](Report& report) {
    report.model = network_->name();
    report.fp16 = network_->options().fp16;
    const SkipMap map = network_->upscaler().skipMap();
    report.interpolated = map.share(SkipMap::Window::interpolated);
    report.kept = map.share(SkipMap::Window::kept);
    report.windowSide = map.side;
    report.exposure = network_->upscaler().exposure();
    report.deviceBytes = network_->upscaler().deviceBytes() + pictures_.byteSize();
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
    base = std::make_unique<PreparedNetwork>(device_, baseName(slot), std::move(model), size_, options);
  }
  giveInputs(*base);
  if (!base->run([&](double) { return !stopping(); })) return;
  base->showOutput(pictures_, slot);
  measured_ = false;
  changed_();
}

}  // namespace xrds
