// Where the pictures come from: files, or a scene that is traced.
#include <algorithm>
#include <utility>

#include "app/failing_with.h"
#include "viewer/upscaling/upscaling.h"

namespace xrds {
namespace fs = std::filesystem;

namespace {

std::vector<fs::path> filesOf(const FrameFiles& files) {
  std::vector<fs::path> paths{files.colour};
  for (const fs::path& path : {files.auxiliary, files.reference})
    if (!path.empty()) paths.push_back(path);
  return paths;
}

// What is told of the first file that is not there; empty if all are.
std::string awaited(const std::vector<fs::path>& files) {
  std::error_code unreadable;
  for (const fs::path& file : files)
    if (!fs::exists(file, unreadable)) return "Waiting for '" + file.string() + "', which is not there yet.";
  return "";
}

}  // namespace

// One step of the live view: more samples, then the picture that they make.
void Upscaling::trace(const Wanted& wanted) {
  constexpr uint32_t kScale = 4;  // of the networks that are fast enough
  if (!live_ || !live_->isOf(wanted.live, kScale)) {
    tell([&](Report& report) { report.waiting = "Preparing the scene " + wanted.live.scene + " ..."; });
    live_.reset();
    frame_.reset();
    live_ = std::make_unique<LiveScene>(vulkan_, device_, wanted.live, kScale);
    clock_.end("preparing");
    size_ = {wanted.live.width, wanted.live.height, kScale, {"albedo", "normal"}};
    upscaled_ = false;
    for (const Slot slot :
         {Slot::output, Slot::bicubic, Slot::demodulated, Slot::guided, Slot::reference, Slot::denoised})
      pictures_.invalidate(slot);
    tell([&](Report& report) {
      report.scene = wanted.live.scene;
      report.startCamera = live_->start();
    });
  }
  live_->look(wanted.live.camera, wanted.temporal);
  if (!live_->finished(wanted.live)) {
    upscaled_ = false;
    if (!live_->refine(wanted.live, [&](size_t, size_t) { return !stopping(); })) return;
    clock_.end("path tracing");
  }
  refining_ = !live_->finished(wanted.live);
  showChosen(wanted);
}

// Returns whether there is a new frame.
bool Upscaling::loadWanted(const Wanted& wanted) {
  FrameFiles files = wanted.files;
  if (!wanted.folder.empty()) files = failingWith(ExitCode::input, [&] { return newestFrame(wanted.folder); });
  const bool same = frame_ && files == frame_->files && samePixels(wanted.layers, served_.layers) &&
                    wanted.reload == served_.reload && wanted.temporal == served_.temporal;
  if (wanted.watching) {
    if (std::exchange(served_.reload, wanted.reload) != wanted.reload) watch_.forget();
    if (!watch_.changed(filesOf(files), std::chrono::steady_clock::now())) {
      const std::string text = frame_ ? "" : awaited(filesOf(files));
      if (!text.empty() && text != report().waiting) tell([&](Report& report) { report.waiting = text; });
      return false;
    }
  } else if (same) {
    return false;
  }
  if (!frame_) tell([&](Report& report) { report.waiting = "Reading " + files.colour.filename().string() + " ..."; });
  if (wanted.reload != served_.reload) {
    moving_.reset();
    constantOf_.reset();
  }
  LoadedFrame loaded = loadFrameOf(wanted, files);
  if (wanted.sequence && wanted.model.empty()) {
    if (std::exchange(constantOf_, wanted.sequence) != wanted.sequence)
      constant_ = constantInput(*wanted.sequence, wanted.layers);
    loaded.constant = constant_;
  }
  served_ = wanted;
  clock_.end("read files");
  takeFrame(std::move(loaded));
  return true;
}

LoadedFrame Upscaling::loadFrameOf(const Wanted& wanted, const FrameFiles& files) {
  if (!wanted.temporal || !wanted.sequence) {
    moving_.reset();
    return failingWith(ExitCode::input, [&] { return loadFrame(files, wanted.layers, wanted.merge); });
  }
  if (!moving_ || !moving_->isOf(wanted)) moving_ = std::make_unique<MovingSequence>(wanted);
  return moving_->merged(device_, wanted.number);
}

void Upscaling::takeFrame(LoadedFrame frame) {
  frame_ = std::move(frame);
  size_ = {static_cast<uint32_t>(frame_->colour.width), static_cast<uint32_t>(frame_->colour.height), frame_->scale,
           frame_->inputs};
  ++frameCount_;
  measured_ = false;
  for (const Slot slot : {Slot::output, Slot::bicubic, Slot::demodulated, Slot::guided, Slot::denoised}) {
    const PictureView now = pictures_.at(slot);
    const bool fits = now.width % static_cast<uint32_t>(frame_->colour.width) == 0 &&
                      now.height % static_cast<uint32_t>(frame_->colour.height) == 0;
    // The last output stays in sight until the next one replaces it, unless it has another size.
    if (slot != Slot::output || !fits) pictures_.invalidate(slot);
  }
  if (!frame_->reference) return pictures_.invalidate(Slot::reference);
  pictures_.upload(Slot::reference, *frame_->reference);
}

}  // namespace xrds
