#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "viewer/live_scene.h"
#include "viewer/watch.h"

namespace xrds {

/// Which windows of a frame may be left out.
struct SkipChoice {
  enum class Mode : uint8_t { off, safe, bounded };
  Mode mode = Mode::off;
  float bounded = 0.02F;  // the bound of that mode
  float bound() const { return mode == Mode::off ? 0 : mode == Mode::safe ? kSafeSkip : bounded; }
};

/// What is to be upscaled, and how.
struct Wanted {
  FrameFiles files;                          // of one frame; no colour: nothing
  bool watching = false;                     // files that are written again and again
  std::shared_ptr<const Sequence> sequence;  // that the files are of, if any
  int number = 0;                            // of the frame in it
  bool temporal = false;                     // merge frames with those around them, a live view with what it has shown
  std::optional<uint32_t> temporalRadius{};  // of files; empty: what suits a frame
  std::string motion{};                      // the layer of files; empty: as `xrds upscale` finds it
  std::filesystem::path folder;              // watched for new files; empty: `files` are meant
  AovRequest layers;
  MergeRequest merge;
  LiveWanted live;    // goes before files
  std::string model;  // a name or a file; empty: the default of the frame's scale, of a live view the fastest
  bool fp16 = false;
  bool denoiseFirst = false;  // by Open Image Denoise's networks, as `xrds upscale --denoise-first` does
  bool cleanGuides = false;   // albedo and normal of the files have no noise
  SkipChoice skip;
  std::optional<float> exposure;  // empty: from the colour
  uint32_t ensemble = 1;          // passes whose mean is taken
  bool wrap = false;              // a panorama
  uint64_t memoryBytes = 0;       // of the device; 0: most of it
  bool exactTiles = false;        // with the bits of the whole frame
  Upscaler::Tune tune = Upscaler::Tune::automatic;
  std::array<bool, kSlotCount> slots{};  // pictures besides input and output that are looked at
  bool metrics = true;
  uint64_t reload = 0;  // another number reads the files again
  bool operator==(const Wanted&) const;
};

/// Whether both take the same layers of a file.
bool samePixels(const AovRequest& a, const AovRequest& b);

}  // namespace xrds
