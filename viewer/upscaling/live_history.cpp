#include "viewer/upscaling/live_history.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "image/camera_motion.h"

namespace xrds {
namespace {

// Samples that count of what was shown: more would show old light for long.
constexpr float kMostCount = 32, kMostGuideCount = 64;
constexpr float kFadedSamples = 64;  // of the present camera, from which on its own picture is shown

FrameCamera::Row rowOf(Vec3 direction, Vec3 origin) {
  return {direction.x, direction.y, direction.z, -dot(direction, origin)};
}

FrameCamera frameCamera(const Camera& camera, float aspect) {
  const float half = std::tan(0.5F * camera.verticalFov);
  const Vec3 forward = normalized(camera.target - camera.position);
  const Vec3 right = normalized(cross(forward, camera.up)), up = cross(right, forward);
  const FrameCamera::Row ahead = rowOf(forward, camera.position);
  return {rowOf(0.5F / (half * aspect) * right + 0.5F * forward, camera.position),
          rowOf(0.5F * forward - 0.5F / half * up, camera.position), ahead, ahead};
}

std::vector<float> downloaded(const DeviceBuffer& buffer) {
  std::vector<float> values(buffer.byteSize() / sizeof(float));
  buffer.download(0, std::as_writable_bytes(std::span(values)));
  return values;
}

void limit(std::vector<float>& counts, float most) {
  for (float& count : counts) count = std::min(count, most);
}

}  // namespace

LiveHistory::LiveHistory(Device& device, uint32_t width, uint32_t height, uint32_t scale)
    : filter_(device, width, height, scale), width_(width), height_(height), scale_(scale) {}

PixelView LiveHistory::view(const std::vector<float>& pixels, uint32_t stride, uint32_t scale) const {
  return {pixels.data(), scale * width_, scale * height_, stride};
}

TemporalFilter::Frame LiveHistory::frameOf(const Shown& shown) const {
  return {.colour = view(shown.colour, shown.stride, 1),
          .fullColour = {},
          .albedo = view(shown.albedo, shown.stride, scale_),
          .normal = view(shown.normal, shown.stride, scale_),
          .depth = shown.depth,
          .lowCounts = shown.lowCounts,
          .fullCounts = shown.fullCounts};
}

// The tracer's pictures, its planes of rows one after the other.
LiveHistory::Shown LiveHistory::taken(const PathTracer& tracer, const Camera& camera) const {
  const std::vector<float> planes = downloaded(tracer.auxiliary());
  const size_t row = size_t{4} * scale_ * width_, pixels = planes.size() / 8;
  Shown shown{.colour = downloaded(tracer.colour()), .stride = 4, .camera = camera};
  shown.albedo.resize(4 * pixels);
  shown.normal.resize(4 * pixels);
  shown.depth.resize(pixels);
  for (size_t y = 0; y < size_t{scale_} * height_; ++y) {
    std::copy_n(&planes[2 * y * row], row, &shown.albedo[y * row]);
    std::copy_n(&planes[(2 * y + 1) * row], row, &shown.normal[y * row]);
  }
  for (size_t p = 0; p < pixels; ++p) shown.depth[p] = 1 / shown.albedo[4 * p + 3];  // infinite of 0
  const SampleCounts samples = tracer.samples();
  shown.lowCounts.assign(size_t{width_} * height_, static_cast<float>(samples.colour));
  shown.fullCounts.assign(pixels, static_cast<float>(samples.auxiliary));
  return shown;
}

void LiveHistory::keep(const PathTracer& tracer, const Camera& camera) {
  if (tracer.samples().colour == 0) return;
  kept_ = merged_ && mergedOf_ == tracer.samples() ? std::exchange(merged_, {}) : taken(tracer, camera);
  merged_.reset();
  limit(kept_->lowCounts, kMostCount);
  limit(kept_->fullCounts, kMostGuideCount);
}

std::optional<LiveHistory::Pictures> LiveHistory::merged(const PathTracer& tracer, const Camera& camera) {
  const float left = 1 - static_cast<float>(tracer.samples().colour) / kFadedSamples;
  if (!kept_ || left <= 0) return {};
  if (!merged_ || mergedOf_ != tracer.samples()) {
    Shown present = taken(tracer, camera);
    const auto wide = static_cast<int>(scale_ * width_), high = static_cast<int>(scale_ * height_);
    const float aspect = static_cast<float>(width_) / static_cast<float>(height_);
    const Box window{0, 0, wide - 1, high - 1};
    const std::vector<float> motion =
        cameraMotion(frameCamera(camera, aspect), frameCamera(kept_->camera, aspect), present.depth, window, window);
    std::vector<float> fadingLow = kept_->lowCounts, fadingFull = kept_->fullCounts;
    for (auto* counts : {&fadingLow, &fadingFull})
      for (float& count : *counts) count *= left;
    TemporalFilter::Frame now = frameOf(present), before = frameOf(*kept_);
    now.toPrevious = motion;
    before.lowCounts = fadingLow;
    before.fullCounts = fadingFull;
    TemporalFilter::Merged made = filter_.run(now, {&before, 1});
    merged_ = Shown{std::move(made.colour),
                    std::move(made.albedo),
                    std::move(made.normal),
                    std::move(present.depth),
                    std::move(made.lowCounts),
                    std::move(made.fullCounts),
                    3,
                    camera};
    mergedOf_ = tracer.samples();
  }
  return Pictures{view(merged_->colour, 3, 1), view(merged_->albedo, 3, scale_), view(merged_->normal, 3, scale_)};
}

}  // namespace xrds
