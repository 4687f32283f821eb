#include "app/frame_motion.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "image/camera_motion.h"
#include "image/layers/aov_candidates.h"

namespace xrds {
namespace {

// The layer's channels of these suffixes in any case; nothing unless it has them all.
std::vector<std::string> channelsOf(const ExrLayer& layer, const std::vector<const char*>& suffixes) {
  std::vector<std::string> names;
  for (const char* suffix : suffixes)
    for (const ExrChannel& channel : layer.channels)
      if (plainName(channel.suffix) == suffix) names.push_back(channel.name);
  return names.size() == suffixes.size() ? names : std::vector<std::string>{};
}

std::vector<std::string> motionChannels(const ExrLayer& layer) {
  for (const std::vector<const char*>& suffixes :
       {std::vector<const char*>{"x", "y", "z", "w"}, {"r", "g", "b", "a"}, {"x", "y"}, {"u", "v"}, {"r", "g"}})
    if (auto channels = channelsOf(layer, suffixes); !channels.empty()) return channels;
  return {};
}

// All layers that have the name and the channels.
std::vector<AovCandidate> motionLayers(const ExrFile& file, const std::string& name) {
  std::vector<AovCandidate> found;
  for (size_t part = 0; part < file.parts.size(); ++part)
    for (const ExrLayer& layer : file.parts[part].layers)
      found.push_back(candidateOf(file, part, layer, motionChannels(layer), layer.name));
  keepIf(found, [](const AovCandidate& layer) { return !layer.selection.channelNames.empty(); });
  if (!name.empty()) return namedBy(file, std::move(found), name);
  keepIf(found, [&](const AovCandidate& layer) {
    return plainName(layer.stem) == "vector" ||
           (isUnnamed(layer) && plainName(file.parts[layer.selection.part].name) == "vector");
  });
  return found;
}

// That of the colour's view and view layer, of the largest part, where there are several.
std::optional<ExrSelection> motionLayer(const ExrFile& file, const std::string& name, const AovPlace& colour) {
  std::vector<AovCandidate> found = motionLayers(file, name);
  for (const std::string& view : {colour.view, std::string()})
    preferIf(found, [&](const AovCandidate& layer) { return layer.view == view; });
  preferIf(found, [&](const AovCandidate& layer) { return layer.prefix == colour.viewLayer; });
  int64_t most = 0;
  for (const AovCandidate& layer : found) most = std::max(most, layer.pixelCount);
  preferIf(found, [&](const AovCandidate& layer) { return layer.pixelCount == most; });
  if (found.empty()) return {};
  if (found.size() == 1) return found.front().selection;
  throw Error("The motion in '" + file.path.string() + "' is ambiguous: expected one layer, found " + placesOf(found) +
              "; name the one to use with --motion LAYER.");
}

// Channels x and y of an image as motion, each times its sign.
std::vector<float> motionOf(const Image& image, std::array<int, 2> channels, std::array<float, 2> signs) {
  std::vector<float> motion(2 * image.pixelCount());
  for (size_t i = 0; i < motion.size(); ++i) {
    const auto channel = static_cast<size_t>(channels[i % 2]);
    motion[i] = signs[i % 2] * image.pixels[i / 2 * static_cast<size_t>(image.channels) + channel];
  }
  return motion;
}

// Of the first part that has one, those of the colour's view first.
std::optional<FrameCamera> cameraIn(const ExrFile& file, const AovPlace& colour) {
  for (const bool ofView : {true, false})
    for (const ExrPart& part : file.parts) {
      const std::string view = isOtherView(file, part.view) ? part.view : "";
      if ((view == colour.view) != ofView) continue;
      if (auto camera = cameraOf(part)) return camera;
    }
  return {};
}

// Nothing if the file cannot be read.
std::optional<FrameCamera> cameraIn(const std::filesystem::path& file, const AovPlace& colour) {
  try {
    return cameraIn(readExrHeader(file), colour);
  } catch (const Error&) {  // told when its turn comes
  }
  return {};
}

// Of a frame without auxiliary images 1.
int scaleOf(const Frame& frame) { return std::max(frame.scale(), 1); }

FrameMotion cameraMotionOf(const Frame& frame, const FrameCamera& camera, const MotionRequest& request,
                           std::vector<float> depth) {
  FrameMotion motion{{}, {}, std::move(depth), true};
  const ExrOutput windows = frame.output(scaleOf(frame));
  const auto towards = [&](const std::filesystem::path& file) {
    const std::optional<FrameCamera> other = file.empty() ? std::nullopt : cameraIn(file, frame.colourPlace());
    return other ? cameraMotion(camera, *other, motion.depth, windows.dataWindow, windows.displayWindow)
                 : std::vector<float>{};
  };
  motion.toPrevious = towards(request.previous);
  motion.toNext = towards(request.next);
  return motion;
}

FrameMotion layerMotionOf(const Frame& frame, const ExrSelection& layer, std::vector<float> depth) {
  if (fitFrame(frame.colourPart(), frame.auxiliaryFile().parts[layer.part]).scale != scaleOf(frame))
    throw Error("The motion layer '" + printable(layer.layer) + "' does not have the size of the " +
                (frame.scale() == 0 ? "colour." : "auxiliary images."));
  const Image image = frame.readFull(layer);
  FrameMotion motion{{}, {}, std::move(depth)};
  motion.toPrevious = motionOf(image, {0, 1}, {1, image.channels == 4 ? -1.F : 1.F});
  if (image.channels == 4) motion.toNext = motionOf(image, {2, 3}, {-1, 1});
  return motion;
}

}  // namespace

FrameMotion readMotion(const Frame& frame, const MotionRequest& request) {
  const ExrFile& file = frame.auxiliaryFile();
  std::vector<float> depth;
  if (!request.depth.empty() || hasAov(file, AovRole::kDepth))
    depth = frame.readFull(findAov(file, AovRole::kDepth, request.depth, frame.colourPlace())).pixels;
  if (const auto layer = motionLayer(file, request.layer, frame.colourPlace()))
    return layerMotionOf(frame, *layer, std::move(depth));
  if (request.layer.empty() && !depth.empty())
    if (const auto camera = cameraIn(file, frame.colourPlace()))
      return cameraMotionOf(frame, *camera, request, std::move(depth));
  throw Error("'" + file.path.string() + "' has no motion " +
              (request.layer.empty() ? "layer 'Vector', nor depth and camera (the attribute worldToNDC)"
                                     : "layer '" + printable(request.layer) + "' of two or four channels") +
              ": render with the pass Vector and without motion blur, or name a layer with --motion.\n" +
              describe(file));
}

}  // namespace xrds
