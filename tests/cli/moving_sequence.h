#pragma once

#include <cmath>

#include "tests/cli/frames.h"

namespace xrds::test {

constexpr int kFrames = 6, kWidth = 16, kHeight = 12;  // of a MovingSequence, at its low resolution

// Numbers in [0, 1) that look like noise, the same on every machine.
inline float noise(int frame, int x, int y, int c) {
  const double mixed = 43758.5453 * std::sin(12.9898 * x + 78.233 * y + 37.719 * c + 11.13 * frame);
  return static_cast<float>(mixed - std::floor(mixed));
}

/// How the files of a sequence tell its motion: a layer's name and channels, or depth and cameras.
struct MotionTold {
  std::string layer = "Vector", channels = "XYZW";
  bool byCameras = false;
  int frames = kFrames;  // at most 9
  int step = 3;          // pixels of the full resolution to the right, a frame
  bool lights = false;   // layers Emit and Env of the colour, 0.3 and 0.7 of it
  bool depth = false;
  bool viewLayers = false;  // all stand in view layer B, beside a view layer A of one grey
};

inline void addViewLayer(Part& part) {
  std::vector<Layer> both;
  for (const Layer& layer : part.layers) {
    const std::string name = layer.name.empty() ? "Combined" : layer.name;
    both.push_back({"A." + name, layer.channels, [](int, int, int) { return 0.5F; }});
    both.push_back({"B." + name, layer.channels, layer.pixels});
  }
  part.layers = std::move(both);
}

/// Frames 1 to 6, or more, of a pattern that moves to the right, under noisy light, as
/// colour.0001.exr and aux.0001.exr.
struct MovingSequence {
  TemporaryFolder folder;

  explicit MovingSequence(const MotionTold& told = {}) {
    for (int frame = 1; frame <= told.frames; ++frame) write(frame, told);
  }

  std::string at(const std::string& kind, int frame) const {
    return (folder / (kind + ".000" + std::to_string(frame) + ".exr")).string();
  }

  void write(int frame, const MotionTold& told) const {
    const Box low = boxOf(kWidth, kHeight), full = boxOf(4 * kWidth, 4 * kHeight);
    const auto light = [frame](float share) {
      return [=](int x, int y, int c) { return share * (0.3F + 0.6F * noise(frame, x, y, c)); };
    };
    Part colour{low, low, {Layer{"", "RGB", light(1)}}};
    if (told.lights)
      colour.layers.insert(colour.layers.end(), {{"Emit", "RGB", light(0.3F)}, {"Env", "RGB", light(0.7F)}});
    if (told.viewLayers) addViewLayer(colour);
    writeParts(at("colour", frame), {colour});
    const Layer albedo{"albedo", "RGB", [=](int x, int y, int) {
                         return (x - told.step * frame + 30) / 6 % 2 == y / 6 % 2 ? 0.3F : 0.7F;
                       }};
    Part part{full, full, {albedo, normalLayer("normal", 4 * kWidth)}};
    if (told.byCameras) {
      // Parallel rays along z, a world's unit to a pixel: the camera moves by the step to the left.
      constexpr float kWide = 1.F / (4 * kWidth), kHigh = 1.F / (4 * kHeight);
      const auto shift = static_cast<float>(told.step * frame);
      part.layers.push_back({"depth", "Z", [](int, int, int) { return 5.F; }});
      part.matrices["worldToNDC"] = {kWide, 0, 0, 0, 0, -kHigh, 0, 0, 0, 0, 1, 0, kWide * shift, 1, 0, 1};
      part.matrices["worldToCamera"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, shift, 0, 0, 1};
    } else {
      // Of Cycles' four: previous less present is minus the step, and present less next as well.
      part.layers.push_back({told.layer, told.channels,
                             [=](int, int, int c) { return c % 2 == 0 ? static_cast<float>(-told.step) : 0.F; }});
    }
    if (told.depth) part.layers.push_back({"Depth", "Z", [](int x, int, int) { return 5 + 0.1F * float(x); }});
    if (told.viewLayers) addViewLayer(part);
    writeParts(at("aux", frame), {part});
  }
};

}  // namespace xrds::test
