#pragma once

#include <functional>
#include <memory>

#include "viewer/tracer/scene.h"
#include "viewer/vulkan/buffer.h"

namespace xrds {

struct TraceOptions {
  uint32_t seed = 1;
  uint32_t maxBounces = 8;  // scatterings of a path
  float indirectClamp = 3;  // most radiance (mean of R, G, B) that indirect light of one sample may bring; 0: no limit
};

/// How often each pixel has been sampled.
struct SampleCounts {
  uint32_t colour = 0, auxiliary = 0;
  bool operator==(const SampleCounts&) const = default;
};

/// A scene on a device, seen by a camera: noisy radiance at low resolution, albedo and normal at full resolution, both
/// refined sample by sample in buffers that the network reads. The same calls give the same bits.
class PathTracer {
 public:
  /// width x height: of the colour; the auxiliary image is `scale` times that. Uploads the scene, which may then go.
  /// Throws Error if the device cannot hold it. The device must outlive the tracer and is used by one thread at a time.
  PathTracer(VulkanDevice& gpu, const TraceScene& scene, uint32_t width, uint32_t height, uint32_t scale,
             const TraceOptions& options = {});
  ~PathTracer();
  PathTracer(PathTracer&&) noexcept;
  PathTracer& operator=(PathTracer&&) noexcept;

  /// A new view: the samples start again. Costs nothing until render(); until then the buffers keep the old view.
  void reset(const Camera& camera);

  /// Called between submissions with those finished and their total; returning false stops the rendering.
  using Progress = std::function<bool(size_t, size_t)>;
  /// Adds samples to every pixel and waits for the end, auxiliary first. On CPU devices a submission is a few rows of
  /// pixels. Returns false if it was stopped: then some rows are ahead of the others, which a further call
  /// tolerates, and samples() counts only whole passes over the picture.
  bool render(SampleCounts more, const Progress& progress = {});

  /// Whole passes since the last reset.
  SampleCounts samples() const;

  /// [height, width, 4] floats: mean linear radiance and 0.
  const DeviceBuffer& colour() const;
  /// [scale height, 2, scale width, 4] floats: of each row first albedo and nearness (of the first hit, 1 / distance
  /// along the viewing direction, 0 of the sky), then normals in camera space (x right, y up, z away from the camera),
  /// facing it, and 0. As Cycles' denoising data: smooth metal and glass show what they reflect, tinted; light sources
  /// and sky have their radiance for an albedo; the sky has no normal (0, 0, 0).
  const DeviceBuffer& auxiliary() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace xrds
