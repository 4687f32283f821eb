#pragma once

#include <optional>
#include <string>
#include <vector>

#include "viewer/tracer/path_tracer.h"
#include "viewer/upscaling/live_history.h"
#include "viewer/upscaling/prepared_network.h"

namespace xrds {

/// What a live view traces. An empty scene: nothing.
struct LiveWanted {
  std::string scene;                   // built-in, or a glTF or OBJ file
  std::optional<Camera> camera;        // empty: the scene's own
  uint32_t width = 128, height = 128;  // of the colour
  uint32_t mostSamples = 1024;
  bool operator==(const LiveWanted&) const = default;
};

/// A scene that is traced on the device, refined from one call to the next. Used by one thread.
class LiveScene {
 public:
  /// Throws Failure if the scene cannot be read, Error if the device cannot hold it. gpu: the same device as `device`.
  LiveScene(VulkanDevice& gpu, Device& device, const LiveWanted& wanted, uint32_t scale);

  /// The names that LiveWanted::scene takes besides files.
  static std::vector<std::string> names();
  /// Throws Error that lists the names if the scene is neither one of them nor a file.
  static void requireExisting(const std::string& scene);

  bool isOf(const LiveWanted& wanted, uint32_t scale) const;
  const Camera& start() const { return start_; }
  uint32_t samples() const { return tracer_.samples().colour; }
  /// Takes the camera; a new one begins anew, `temporal`: with what the last one has shown.
  void look(const std::optional<Camera>& camera, bool temporal);
  /// Nothing is left to be refined.
  bool finished(const LiveWanted& wanted) const { return samples() >= wanted.mostSamples; }
  /// Adds samples: one at first, more at once while nothing moves. Returns false if `progress` stopped it.
  bool refine(const LiveWanted& wanted, const PathTracer::Progress& progress);
  /// Gives its pictures, merged or not. Returns whether they are.
  bool giveTo(PreparedNetwork& network);

 private:
  Device& device_;
  LiveWanted made_;
  uint32_t scale_;
  Camera start_, camera_;
  PathTracer tracer_;
  std::optional<LiveHistory> history_;
};

}  // namespace xrds
