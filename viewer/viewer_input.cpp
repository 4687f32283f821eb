// What the user does.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "viewer/viewer.h"
#include "xrds/error.h"
#include "xrds/path_text.h"

namespace xrds {
namespace fs = std::filesystem;

namespace {

constexpr double kGrip = 8;  // display pixels around the divider in which it can be grasped

// "xrds-0001.png" or the next one that is free.
fs::path freeName(const std::string& extension) {
  for (int number = 1;; ++number) {
    char name[32];
    std::snprintf(name, sizeof name, "xrds-%04d%s", number, extension.c_str());
    if (std::error_code ignored; !fs::exists(name, ignored)) return name;
  }
}

}  // namespace

void Viewer::listen() {
  events_.key = [this](int key, int modifiers) { pressKey(key, modifiers); };
  events_.button = [this](int button, bool pressed) { pressButton(button, pressed); };
  events_.move = [this](double x, double y) { moveCursor(x, y); };
  events_.scroll = [this](double steps) { turnWheel(steps); };
  events_.drop = [this](const std::vector<std::string>& files) { openAsked(files); };
  events_.redraw = [this] { needDrawing(); };
  events_.rescale = [this] {
    swapchain_.wait();
    panel_.rescale();
    needDrawing();
  };
}

void Viewer::openAsked(const std::vector<std::string>& files) {
  touched_ = true;
  try {
    open(files);
  } catch (const Error& failure) {
    upscaling_->fail({ExitCode::input, failure.what()});
  }
  needDrawing();
}

// One folder is watched; names with '#' are a sequence; files of a frame may come in any order.
void Viewer::open(const std::vector<std::string>& files) {
  Wanted wanted = wanted_;
  Playback playback = playback_;
  wanted.files = {};
  wanted.folder.clear();
  wanted.live.scene.clear();
  wanted.sequence.reset();
  wanted.temporal = isTemporal(options_, false);
  wanted.watching = options_.watch;
  playback.frames.reset();
  playback.index = 0;
  playback.playing = false;
  std::vector<fs::path> paths;
  for (const std::string& file : files) paths.push_back(pathOf(file));
  if (std::error_code ignored; paths.size() == 1 && fs::is_directory(paths[0], ignored)) {
    wanted.folder = paths[0];
    wanted.watching = true;
  } else if (std::any_of(paths.begin(), paths.end(), isSequence)) {
    FrameFiles patterns = sortPatterns(paths);
    if (!options_.reference.empty()) patterns.reference = pathOf(options_.reference);
    playback.frames = std::make_shared<const Sequence>(sequenceOf(patterns));
    wanted.watching = false;
    wanted.sequence = playback.frames;
  } else if (options_.watch) {  // they need not be there yet
    wanted.files = {paths[0], paths.size() > 1 ? paths[1] : "", pathOf(options_.reference)};
    if (paths.size() > 2) wanted.files.reference = paths[2];
  } else {
    wanted.files = sortFiles(paths);
    if (!options_.reference.empty()) wanted.files.reference = pathOf(options_.reference);
  }
  ++wanted.reload;
  wanted_ = std::move(wanted);
  playback_ = std::move(playback);
  if (playback_.frames) wanted_.files = playback_.frames->front().files;
  display_.title(paths[0].filename().string() + " - xrds");
}

void Viewer::pressKey(int key, int modifiers) {
  needDrawing();
  touched_ = true;
  if (panel_.takesKeys()) return;
  if (browser_.isOpen()) return browser_.pressKey(key, modifiers);
  if (const auto pressed = commandOf(key, modifiers)) perform(pressed->command, pressed->digit);
}

void Viewer::perform(Command command, int digit) {
  needDrawing();
  if (performView(command, digit) || performFrame(command) || performLive(command)) return;
  switch (command) {
    case Command::quit:
      quit_ = true;
      break;
    case Command::help:
      view_.help = !view_.help;
      break;
    case Command::panel:
      view_.panel = view_.unfolded = !view_.panel;
      break;
    case Command::openFiles:
      browser_.open();
      break;
    case Command::nextModel:
      chooseModel(1);
      break;
    case Command::previousModel:
      chooseModel(-1);
      break;
    case Command::precision:
      wanted_.fp16 = !wanted_.fp16;
      break;
    case Command::denoiseFirst:
      wanted_.denoiseFirst = !wanted_.denoiseFirst;
      break;
    case Command::skip:
      wanted_.skip.mode = static_cast<SkipChoice::Mode>((static_cast<int>(wanted_.skip.mode) + 1) % 3);
      break;
    case Command::temporal:
      wanted_.temporal = !wanted_.temporal;
      break;
    case Command::reload:
      ++wanted_.reload;
      break;
    case Command::screenshot:
      screenshot_ = {freeName(".png"), true};
      break;
    case Command::save:
      upscaling_->save(freeName(".exr"));
      break;
    default:
      break;
  }
}

bool Viewer::performView(Command command, int digit) {
  constexpr double kStep = 48;
  Viewport& viewport = view_.viewport;
  const double middleX = viewport.areaWidth / 2, middleY = viewport.areaHeight / 2;
  switch (command) {
    case Command::wipe:
      return view_.wiping = !view_.wiping, true;
    case Command::wipeLeft:
      return view_.wipe = std::max(0.0, view_.wipe - 0.02), true;
    case Command::wipeRight:
      return view_.wipe = std::min(1.0, view_.wipe + 0.02), true;
    case Command::showRight:
      return view_.right = static_cast<View>(digit), true;
    case Command::showLeft:
      return view_.left = static_cast<View>(digit), view_.wiping = true;
    case Command::flickerRight:
      return view_.right = view_.right == View::flicker ? View::output : View::flicker, true;
    case Command::flickerLeft:
      return view_.left = View::flicker, view_.wiping = true;
    case Command::denoisedRight:
      return view_.right = view_.right == View::denoised ? View::output : View::denoised, true;
    case Command::denoisedLeft:
      return view_.left = View::denoised, view_.wiping = true;
    case Command::zoomIn:
      return viewport.zoomAbout(middleX, middleY, viewport.zoomStep(1)), true;
    case Command::zoomOut:
      return viewport.zoomAbout(middleX, middleY, viewport.zoomStep(-1)), true;
    case Command::fit:
      return viewport.fit(), true;
    case Command::pixels:
      return viewport.zoomAbout(middleX, middleY, 1), true;
    case Command::panLeft:
      return viewport.pan(kStep, 0), true;
    case Command::panRight:
      return viewport.pan(-kStep, 0), true;
    case Command::panUp:
      return viewport.pan(0, kStep), true;
    case Command::panDown:
      return viewport.pan(0, -kStep), true;
    case Command::brighter:
      return view_.stops = std::min(view_.stops + 0.5F, 10.F), true;
    case Command::darker:
      return view_.stops = std::max(view_.stops - 0.5F, -10.F), true;
    case Command::resetExposure:
      return view_.stops = 0, true;
    case Command::curve:
      return view_.curve = 1 - view_.curve, true;
    default:
      return false;
  }
}

bool Viewer::performFrame(Command command) {
  const size_t count = playback_.count();
  if (command == Command::loop) return playback_.looping = !playback_.looping, true;
  if (command == Command::play) {
    if (count == 0) return true;
    playback_.playing = !playback_.playing;
    if (playback_.playing && playback_.index + 1 == count) playback_.index = 0;
    nextFrame_ = std::chrono::steady_clock::now();
    return true;
  }
  const auto show = [&](size_t index) {
    playback_.playing = false;
    if (count > 0) playback_.index = index;
    return true;
  };
  if (command == Command::firstFrame) return show(0);
  if (command == Command::lastFrame) return show(count - 1);
  if (command == Command::nextFrame) return show(std::min(playback_.index + 1, std::max<size_t>(count, 1) - 1));
  if (command == Command::previousFrame) return show(playback_.index > 0 ? playback_.index - 1 : 0);
  return false;
}

bool Viewer::performLive(Command command) {
  constexpr float kAngle = 0.1F, kFactor = 1.1F;
  if (command == Command::nextScene) {
    const std::vector<std::string> scenes = LiveScene::names();
    const auto now = std::find(scenes.begin(), scenes.end(), wanted_.live.scene);
    showScene(now == scenes.end() || now + 1 == scenes.end() ? scenes[0] : *(now + 1));
    return true;
  }
  if (command < Command::orbitLeft || command > Command::startView) return false;
  if (!orbit_) return true;
  switch (command) {
    case Command::orbitLeft:
      return orbit_->turn(-kAngle, 0), true;
    case Command::orbitRight:
      return orbit_->turn(kAngle, 0), true;
    case Command::orbitUp:
      return orbit_->turn(0, kAngle), true;
    case Command::orbitDown:
      return orbit_->turn(0, -kAngle), true;
    case Command::closer:
      return orbit_->approach(1 / kFactor), true;
    case Command::farther:
      return orbit_->approach(kFactor), true;
    default:
      return orbit_.emplace(orbit_->start), true;
  }
}

void Viewer::showScene(const std::string& scene) {
  wanted_.files = {};
  wanted_.folder.clear();
  wanted_.watching = false;
  wanted_.sequence.reset();
  wanted_.temporal = isTemporal(options_, true);
  wanted_.live.scene = scene;
  wanted_.live.camera.reset();
  playback_.frames.reset();
  orbit_.reset();
  display_.title(pathOf(scene).filename().string() + " - xrds");
}

void Viewer::chooseModel(int step) {
  if (models_.empty()) return;
  const std::string& current = wanted_.model.empty() ? report_.model : wanted_.model;
  const auto found = std::find(models_.begin(), models_.end(), current);
  const auto count = static_cast<int>(models_.size());
  const int index = found == models_.end() ? 0 : static_cast<int>(found - models_.begin());
  wanted_.model = models_[static_cast<size_t>((index + step + count) % count)];
}

void Viewer::pressButton(int button, bool pressed) {
  needDrawing();
  touched_ = true;
  if (!pressed) draggingWipe_ = draggingPicture_ = draggingCamera_ = false;
  if (!pressed || panel_.takesMouse()) return;
  const bool onDivider = view_.wiping && std::abs(cursorX_ - view_.divider()) < kGrip * panel_.scale();
  draggingWipe_ = button == GLFW_MOUSE_BUTTON_LEFT && onDivider;
  draggingCamera_ = orbit_ && !draggingWipe_ && button == GLFW_MOUSE_BUTTON_LEFT;
  draggingPicture_ = !draggingWipe_ && !draggingCamera_;
}

void Viewer::moveCursor(double x, double y) {
  needDrawing(2);
  const Viewport& viewport = view_.viewport;
  if (draggingWipe_) view_.wipe = std::clamp((x - viewport.left) / (viewport.zoom * viewport.pictureWidth), 0.0, 1.0);
  constexpr double kAnglePerPixel = 0.006;
  if (draggingCamera_)
    orbit_->turn(static_cast<float>(kAnglePerPixel * (cursorX_ - x)),
                 static_cast<float>(kAnglePerPixel * (y - cursorY_)));
  if (draggingPicture_) view_.viewport.pan(x - cursorX_, y - cursorY_);
  cursorX_ = x;
  cursorY_ = y;
}

void Viewer::turnWheel(double steps) {
  needDrawing();
  if (panel_.takesMouse() || steps == 0) return;
  view_.viewport.zoomAbout(cursorX_, cursorY_, view_.viewport.zoomStep(steps > 0 ? 1 : -1));
}

}  // namespace xrds
