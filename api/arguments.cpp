#include "api/arguments.h"

#include <cmath>
#include <cstdio>

#include "frames/ensemble.h"
#include "frames/tile_choice.h"
#include "xrds/error.h"

namespace xrds {
namespace {

std::string numberText(float value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", static_cast<double>(value));
  return text;
}

void checkExposure(const Upscaler::Options& options) {
  if (options.exposure && !Upscaler::isExposure(*options.exposure))
    throw InvalidArgument("An exposure of " + numberText(*options.exposure) +
                          " was given, expected a number between 1e-30 and 1e30.");
}

void checkSkip(const SkipOptions& options) {
  if (!std::isfinite(options.bound) || options.bound < 0)
    throw InvalidArgument("A skip bound of " + numberText(options.bound) +
                          " was given, expected 0, which skips nothing, or a small positive number such as 0.005.");
}

void checkEnsemble(const Upscaler::Options& options) {
  mirrorsOf(options.ensemble);
  if (options.ensemble > 1 && options.skip.keepUnchanged)
    throw InvalidArgument(
        "Windows that did not change are kept from pass to pass, not from frame to frame: no ensemble, please.");
  if (options.ensemble == 8 && options.tiles.wrap)
    throw InvalidArgument("A panorama cannot be mirrored on its diagonal: take an ensemble of 4.");
}

void checkTileCount(const char* name, uint32_t count) {
  if (count > kMostTiles)
    throw InvalidArgument(std::to_string(count) + " " + name + " of tiles were asked for, expected at most " +
                          std::to_string(kMostTiles) + ", or 0 for what fits the memory.");
}

void checkPixels(const std::string& what, const PixelView& image) {
  if (!image.pixels) throw InvalidArgument("The " + what + " image has no pixels: its pointer is null.");
  if (image.stride < 3)
    throw InvalidArgument("The " + what + " image has a stride of " + std::to_string(image.stride) +
                          " floats from pixel to pixel, expected at least 3.");
}

}  // namespace

void checkOptions(const TileOptions& options) {
  checkTileCount("columns", options.columns);
  checkTileCount("rows", options.rows);
  if (options.halo.value_or(0) > kMaxSide)
    throw InvalidArgument("A halo of " + std::to_string(*options.halo) + " pixels was asked for, expected at most " +
                          std::to_string(kMaxSide) + ".");
}

void checkOptions(const Upscaler::Options& options) {
  checkExposure(options);
  checkSkip(options.skip);
  checkEnsemble(options);
  checkOptions(options.tiles);
  if (options.multiplyAddsPerSubmission == 0)
    throw InvalidArgument(
        "0 multiply-adds a submission were asked for, expected at least 1; some 10^10 take a GPU milliseconds.");
}

void checkShape(const NetworkConfig& config, FrameShape frame) {
  constexpr uint32_t kMostPixels = kMostTiles * kMaxSide;  // of the output, to a side
  const auto fits = [&](uint32_t side) { return side > 0 && side <= kMostPixels / config.scale; };
  if (!fits(frame.width) || !fits(frame.height))
    throw InvalidArgument("A frame of " + sizeText(frame.width, frame.height) + " pixels cannot be upscaled by " +
                          std::to_string(config.scale) + ": each side of the output must be 1 to " +
                          std::to_string(kMostPixels) + " pixels.");
}

void checkImages(const NetworkConfig& config, FrameShape frame, const PixelView& colour,
                 std::span<const PixelView> auxiliary) {
  if (colour.width != frame.width || colour.height != frame.height)
    throw InvalidArgument("The colour image is " + sizeText(colour.width, colour.height) + " pixels, expected " +
                          sizeText(frame.width, frame.height) + ".");
  checkPixels("colour", colour);
  if (auxiliary.size() != config.auxInputs.size())
    throw InvalidArgument("The model takes " + std::to_string(config.auxInputs.size()) + " auxiliary images, found " +
                          std::to_string(auxiliary.size()) + ".");
  for (size_t i = 0; i < auxiliary.size(); ++i) {
    if (auxiliary[i].width != config.scale * frame.width || auxiliary[i].height != config.scale * frame.height)
      throw InvalidArgument(
          "The " + config.auxInputs[i] + " image is " + sizeText(auxiliary[i].width, auxiliary[i].height) +
          " pixels, expected " + sizeText(config.scale * frame.width, config.scale * frame.height) + ": " +
          std::to_string(config.scale) + " times the colour's " + sizeText(frame.width, frame.height) + ".");
    checkPixels(config.auxInputs[i], auxiliary[i]);
  }
}

void checkOutput(const NetworkConfig& config, FrameShape frame, std::span<const float> output) {
  const size_t numbers = size_t{3} * config.scale * frame.width * config.scale * frame.height;
  if (output.size() != numbers)
    throw InvalidArgument("The output has room for " + std::to_string(output.size()) + " numbers, expected " +
                          std::to_string(numbers) + ": 3 for each of its " +
                          sizeText(config.scale * frame.width, config.scale * frame.height) + " pixels.");
  if (!output.data()) throw InvalidArgument("The output has no room for its numbers: its pointer is null.");
}

std::string sizeText(uint32_t width, uint32_t height) { return std::to_string(width) + " x " + std::to_string(height); }

}  // namespace xrds
