#include "viewer/viewer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <utility>

#include "app/byte_count.h"
#include "app/failing_with.h"
#include "app/models.h"
#include "app/network_options.h"
#include "app/pixel_size.h"
#include "app/skip_bound.h"
#include "image/png_write.h"
#include "image/srgb.h"
#include "viewer/display/placement.h"
#include "xrds/path_text.h"

namespace xrds {
namespace fs = std::filesystem;

namespace {

constexpr auto kBarPeriod = std::chrono::milliseconds(250);

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Of the window and of a live view's colour.
PixelSize sizeOf(const std::string& text, const char* option) { return parsePixelSize(text, option, 8, 16384); }

SkipChoice skipChoice(const std::string& text) {
  if (text == "off") return {};
  if (text == "safe") return {SkipChoice::Mode::safe};
  return {SkipChoice::Mode::bounded, parseSkip(text)};
}

Placement placementOf(const ViewerOptions& options) {
  if (options.size.empty()) return readPlacement(placementFile());
  const auto [width, height] = sizeOf(options.size, "--size");
  return {static_cast<int>(width), static_cast<int>(height)};
}

// Of a live view or, LOW,HIGH, of the two renders of files.
void takeSamples(const std::string& text, const ViewerOptions& options, Wanted& wanted) {
  const bool isPair = text.find(',') != std::string::npos;
  if (isPair && !options.scene.empty())
    throw Failure{ExitCode::usage, "--samples of a live view is one number, found '" + text + "'."};
  if (!isPair && !text.empty()) wanted.live.mostSamples = static_cast<uint32_t>(std::stoul(text));
  wanted.merge = mergeRequest(options.auxColour, isPair ? text : "", wanted.layers);
}

}  // namespace

bool isTemporal(const ViewerOptions& options, bool live) {
  return options.temporal == "on" || (options.temporal == "auto" && live);
}

Wanted wantedOf(const ViewerOptions& options) {
  if (!options.model.empty()) failingWith(ExitCode::model, [&] { Model{resolveModel(options.model)}; });
  if (!options.scene.empty()) failingWith(ExitCode::input, [&] { LiveScene::requireExisting(options.scene); });
  Wanted wanted;
  wanted.layers = options.layers;
  takeSamples(options.samples, options, wanted);
  wanted.model = options.model;
  wanted.fp16 = options.precision == kFp16;
  wanted.denoiseFirst = options.denoiseFirst;
  wanted.cleanGuides = options.cleanGuides;
  wanted.skip = skipChoice(options.skip);
  wanted.exposure = parseExposure(options.exposure);
  wanted.ensemble = options.ensemble;
  wanted.wrap = options.wrap;
  requirePanorama(wanted.wrap, wanted.ensemble, wanted.skip.bound());
  wanted.memoryBytes = parseBytes(options.memory);
  wanted.exactTiles = options.tiles == "exact";
  wanted.temporalRadius = options.temporalRadius;
  wanted.motion = options.motion;
  if (options.tune != "auto") wanted.tune = options.tune == "now" ? Upscaler::Tune::now : Upscaler::Tune::never;
  const auto [width, height] = sizeOf(options.liveSize, "--live-size");
  wanted.live.width = width;
  wanted.live.height = height;
  return wanted;
}

VulkanOptions Viewer::vulkanOptions() {
  VulkanOptions options{.select = options_.device, .validation = options_.validation};
  options.onMessage = [this](std::string_view message) {
    ++complaints_;
    std::fprintf(stderr, "xrds: validation: %.*s\n", static_cast<int>(message.size()), message.data());
  };
  options.instanceExtensions = desktop_.instanceExtensions();
  return options;
}

Viewer::Viewer(const ViewerOptions& options)
    : options_(options),
      wanted_(wantedOf(options)),
      vulkan_(vulkanOptions()),
      device_(vulkan_.shared()),
      display_(desktop_, "xrds", placementOf(options), events_),
      swapchain_(vulkan_, display_),
      pictures_(vulkan_),
      canvas_(vulkan_, pictures_, swapchain_.renderPass()),
      panel_(vulkan_, display_, swapchain_),
      probeBuffer_(vulkan_, 3 * kProbeRowBytes),
      models_(shippedModels()) {
  playback_.framesPerSecond = static_cast<float>(options.framesPerSecond);
  if (!options.model.empty() && std::find(models_.begin(), models_.end(), options.model) == models_.end())
    models_.push_back(options.model);
  listen();
  upscaling_ = std::make_unique<Upscaling>(vulkan_, device_, pictures_, [this] {
    changed_ = true;
    Display::wake();
  });
  if (!options.scene.empty()) showScene(options.scene);
  if (!options.files.empty()) failingWith(ExitCode::input, [&] { open(options.files); });
  playback_.playing = playback_.count() > 1 && options.frames > 1;  // a sequence that stands still makes one picture
  if (!options.script.empty())
    script_ = failingWith(ExitCode::usage, [&] {
      return std::make_unique<Script>(readScript(pathOf(options.script)), scriptVerbs(), scriptActions());
    });
}

Viewer::~Viewer() {
  upscaling_.reset();
  swapchain_.wait();
}

bool Viewer::leave() {
  constexpr auto kPatience = std::chrono::milliseconds(400);
  if (options_.size.empty()) writePlacement(placementFile(), display_.placement());
  display_.hide();
  return upscaling_->stop(kPatience);
}

void Viewer::run() {
  const auto start = Clock::now();
  clocked_ = {start, std::clock()};
  while (!display_.closing() && !quit_) takeTurn();
  measured_.seconds = secondsSince(start);
  if (options_.statistics) printStatistics();
  if (complaints_ > 0)
    throw Failure{ExitCode::bug, "Vulkan's validation layers complained " + std::to_string(complaints_) + " times."};
  if (!options_.screenshot.empty())
    throw Failure{ExitCode::output, "The screenshot '" + options_.screenshot +
                                        "' was not written: the viewer was left before it had upscaled " +
                                        std::to_string(options_.frames) + " pictures (--frames)."};
}

// Seconds until something is to be done without an event; nothing: never.
std::optional<double> Viewer::patience() const {
  if (dirty_ > 0 && !display_.minimized()) return 0;
  std::optional<double> least;
  const auto consider = [&](std::optional<double> seconds) {
    if (seconds) least = std::max(0.0, std::min(*seconds, least.value_or(*seconds)));
  };
  if (script_) consider(script_->patience(ready()));
  if (playback_.playing && report_.settled) consider(std::chrono::duration<double>(nextFrame_ - Clock::now()).count());
  if (report_.share < 1) consider(std::chrono::duration<double>(kBarPeriod).count());
  return least;
}

void Viewer::takeTurn() {
  display_.handleEvents(patience());
  const auto start = Clock::now();
  if (changed_.exchange(false)) needDrawing(probe_.x >= 0 ? 2 : 1);  // the values come one drawing late
  report_ = upscaling_->report();
  if (!report_.error.empty() && report_.pictures == 0 && !touched_) throw Failure{report_.failure, report_.error};
  // The bar moves a few times a second only: drawing takes the device's time from the network.
  if (report_.share < 1 && Clock::now() - lastBar_ > kBarPeriod) {
    lastBar_ = Clock::now();
    needDrawing(1);
  }
  if (!wanted_.live.scene.empty() && !orbit_ && report_.scene == wanted_.live.scene)
    orbit_.emplace(report_.startCamera);
  advancePlayback();
  if (script_) failingWith(ExitCode::usage, [this] { script_->step(ready()); });
  // The first drawing says what is prepared; after that a CPU's queue may be busy compiling.
  if (measured_.drawings > 0 || display_.minimized()) updateWanted();
  if (dirty_ > 0 && !display_.minimized()) {
    --dirty_;
    draw();
    measureTurn(secondsSince(start));
  }
  if (script_ && script_->finished() && ready()) quit_ = true;
  if (options_.frames > 0 && report_.pictures >= static_cast<uint64_t>(options_.frames) && dirty_ == 0) {
    if (!options_.screenshot.empty() && screenshot_.path.empty()) {
      screenshot_ = {pathOf(std::exchange(options_.screenshot, {}))};
      needDrawing(1);
    } else {
      quit_ = true;
    }
  }
}

// Of handling events and drawing. Until the first picture is there CPU devices compile what draws it.
void Viewer::measureTurn(double seconds) {
  ++measured_.drawings;
  clocked_.turns += seconds;
  clocked_.longestTurn = std::max(clocked_.longestTurn, seconds);
  if (report_.pictures == 0) return;
  measured_.slowestTurn = std::max(measured_.slowestTurn, seconds);
  measured_.turns += seconds;
  ++measured_.turnCount;
}

// Whether all that was asked for is on the display.
bool Viewer::ready() const {
  if (playback_.playing) return report_.pictures >= awaited_;  // the next frame is always on its way
  const bool sampled = awaitedSamples_ > 0 && report_.current && report_.error.empty() &&
                       report_.samples >= std::min(awaitedSamples_, wanted_.live.mostSamples);
  return (report_.settled || sampled) && !changed_ && (dirty_ == 0 || display_.minimized()) &&
         report_.pictures >= awaited_;
}

void Viewer::advancePlayback() {
  if (!playback_.playing || !playback_.frames || !report_.settled || Clock::now() < nextFrame_) return;
  const bool last = playback_.index + 1 == playback_.count();
  if (last && !playback_.looping) {
    playback_.playing = false;
    return needDrawing();
  }
  playback_.index = last ? 0 : playback_.index + 1;
  const auto period = std::chrono::duration<double>(1 / std::max(playback_.framesPerSecond, 0.1F));
  nextFrame_ = std::max(nextFrame_, Clock::now() - std::chrono::milliseconds(100)) +
               std::chrono::duration_cast<Clock::duration>(period);
}

void Viewer::updateWanted() {
  if (playback_.frames) {
    wanted_.files = (*playback_.frames)[playback_.index].files;
    wanted_.number = (*playback_.frames)[playback_.index].number;
  }
  if (orbit_) wanted_.live.camera = orbit_->camera();
  wanted_.metrics = !playback_.playing;
  wanted_.slots = {};
  for (const View view : {view_.right, view_.wiping ? view_.left : view_.right})
    wanted_.slots[static_cast<size_t>(Canvas::choiceOf(view).slot)] = true;
  for (const Slot slot : {Slot::input, Slot::auxiliary, Slot::output, Slot::reference})
    wanted_.slots[static_cast<size_t>(slot)] = false;
  upscaling_->want(wanted_);
}

void Viewer::placeViewport() {
  const PictureView input = pictures_.at(Slot::input);
  if (!input.valid) return;
  const VkExtent2D extent = swapchain_.extent();
  const double width = extent.width - std::min(panel_.width(view_, extent.width), extent.width - 1);
  view_.windowSide = report_.windowSide;
  view_.viewport.resize(width, extent.height, report_.scale * input.width, report_.scale * input.height);
}

void Viewer::draw() {
  const auto start = Clock::now();
  swapchain_.wait();
  readProbe();
  const auto hold = pictures_.hold();
  placeViewport();
  PanelModel model{.view = view_,
                   .wanted = wanted_,
                   .playback = playback_,
                   .report = report_,
                   .probe = probe_,
                   .models = models_,
                   .browser = browser_,
                   .hasPicture = pictures_.at(Slot::input).valid,
                   .shownLeft = canvas_.shownFor(view_.left),
                   .shownRight = canvas_.shownFor(view_.right),
                   .drawMilliseconds = drawMilliseconds_,
                   .longestTurnMilliseconds = 1000 * measured_.slowestTurn,
                   .perform = [this](Command command) { perform(command, 0); }};
  panel_.layOut(model, swapchain_.extent());
  placeViewport();  // the panel may have come or gone
  if (!screenshot_.path.empty()) swapchain_.captureNext();
  const bool drawn = swapchain_.draw(
      [&](VkCommandBuffer commands) { recordProbe(commands); },
      [&](VkCommandBuffer commands) {
        const VkExtent2D extent = swapchain_.extent();
        canvas_.draw(commands, view_, extent.width - std::min(panel_.width(view_, extent.width), extent.width),
                     extent.height);
        Panel::draw(commands);
      });
  drawMilliseconds_ = 1000 * secondsSince(start);
  if (drawn && !screenshot_.path.empty()) saveScreenshot(std::exchange(screenshot_, {}));
}

void Viewer::saveScreenshot(const AskedScreenshot& asked) {
  const Screenshot& shot = swapchain_.screenshot();
  Image image(static_cast<int>(shot.width), static_cast<int>(shot.height), 3);
  for (size_t i = 0; i < shot.pixels.size(); ++i)
    image.pixels[i] = static_cast<float>(linearFromSrgb(shot.pixels[i] / 255.0));
  try {
    writePng(asked.path, image);
    upscaling_->note("Saved " + asked.path.string());
  } catch (const Error& failure) {
    if (!asked.isByKey) throw Failure{ExitCode::output, failure.what()};
    upscaling_->fail({ExitCode::output, failure.what()});
  }
}

void Viewer::printStatistics() const {
  const double busy = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  std::printf(
      "seconds %.2f, pictures %llu (%.2f a second), drawings %llu (mean turn %.1f ms, slowest %.1f ms), processor "
      "seconds %.2f\n",
      measured_.seconds, static_cast<unsigned long long>(report_.pictures),
      static_cast<double>(report_.pictures) / measured_.seconds, static_cast<unsigned long long>(measured_.drawings),
      1000 * measured_.turns / std::max<double>(1, static_cast<double>(measured_.turnCount)),
      1000 * measured_.slowestTurn, busy);
}

}  // namespace xrds
