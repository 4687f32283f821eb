#include "viewer/live_scene.h"

#include <algorithm>

#include "app/failing_with.h"
#include "app/listed.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

constexpr uint32_t kMostAuxiliarySamples = 64;  // albedo and normal are clean by then

TraceScene sceneOf(const std::string& name) {
  const auto names = LiveScene::names();
  return std::find(names.begin(), names.end(), name) != names.end() ? builtInScene(name) : loadScene(pathOf(name));
}

PathTracer makeTracer(VulkanDevice& gpu, const LiveWanted& wanted, uint32_t scale, Camera& start) {
  const TraceScene scene = failingWith(ExitCode::input, [&] { return sceneOf(wanted.scene); });
  start = scene.camera;
  return {gpu, scene, wanted.width, wanted.height, scale};
}

}  // namespace

LiveScene::LiveScene(VulkanDevice& gpu, Device& device, const LiveWanted& wanted, uint32_t scale)
    : device_(device), made_(wanted), scale_(scale), tracer_(makeTracer(gpu, wanted, scale, start_)) {
  camera_ = start_;
  tracer_.reset(camera_);
}

std::vector<std::string> LiveScene::names() { return builtInSceneNames(); }

void LiveScene::requireExisting(const std::string& scene) {
  const auto known = names();
  std::error_code ignored;
  if (std::find(known.begin(), known.end(), scene) != known.end() || std::filesystem::exists(pathOf(scene), ignored))
    return;
  throw Error("There is no scene '" + scene + "': give a glTF or OBJ file or a built-in scene, " + listed(known) + ".");
}

bool LiveScene::isOf(const LiveWanted& wanted, uint32_t scale) const {
  return wanted.scene == made_.scene && wanted.width == made_.width && wanted.height == made_.height && scale == scale_;
}

void LiveScene::look(const std::optional<Camera>& camera, bool temporal) {
  if (!temporal) history_.reset();
  const Camera wanted = camera.value_or(start_);
  if (wanted == camera_) return;
  if (temporal) {
    if (!history_) history_.emplace(device_, made_.width, made_.height, scale_);
    history_->keep(tracer_, camera_);
  }
  camera_ = wanted;
  tracer_.reset(camera_);
}

bool LiveScene::giveTo(PreparedNetwork& network) {
  const auto merged = history_ ? history_->merged(tracer_, camera_) : std::nullopt;
  if (merged)
    network.takeLive(merged->colour, merged->albedo, merged->normal);
  else
    network.take(tracer_.colour(), tracer_.auxiliary());
  return merged.has_value();
}

bool LiveScene::refine(const LiveWanted& wanted, const PathTracer::Progress& progress) {
  const SampleCounts now = tracer_.samples();
  SampleCounts more;
  more.colour = std::min(std::clamp(now.colour / 2, 1U, 8U), wanted.mostSamples - now.colour);
  more.auxiliary = now.auxiliary < kMostAuxiliarySamples ? std::clamp(now.auxiliary / 8, 1U, 4U) : 0;
  return tracer_.render(more, progress);
}

}  // namespace xrds
