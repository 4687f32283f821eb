#pragma once

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "image/exr/write.h"
#include "image/layers/aov.h"
#include "image/test_files.h"
#include "tests/cli/process.h"
#include "tests/temporary_folder.h"

namespace xrds::test {

/// The value of channel c at column x and row y of a data window.
using Pixels = std::function<float(int x, int y, int c)>;

/// One layer of a made-up render; `channels` are suffixes such as "RGB" or "XYZ".
struct Layer {
  std::string name;
  std::string channels = "RGB";
  Pixels pixels;
};

/// One part of a made-up render.
struct Part {
  Box dataWindow, displayWindow;
  std::vector<Layer> layers;
  std::string name = {};
  std::map<std::string, std::string> texts = {};               // attributes
  std::map<std::string, std::array<float, 16>> matrices = {};  // row by row
  std::map<std::string, int> numbers = {};                     // attributes
};

/// Writes 32-bit float parts; every header gets the text attribute "renderer" and the float "cameraZoom".
void writeParts(const std::filesystem::path& path, const std::vector<Part>& parts);

Box boxOf(int width, int height);
/// Plausible layers: smooth, with an edge in the middle; `width` is the layer's own.
Layer colourLayer(const std::string& name, int width);
Layer albedoLayer(const std::string& name, int width);
Layer normalLayer(const std::string& name, int width);

/// The image as a layer.
Layer layerOf(const std::string& name, const std::vector<float>& values, int width);

/// A frame of 90 x 70 pixels for scale 4: noise on the left of column `edge`, an even background on its right; in the
/// colour, the rows from `brighter` on are brighter.
void writeHalfEvenFrame(const std::filesystem::path& color, const std::filesystem::path& aux, int edge,
                        int brighter = 70);

/// A folder with colour.exr (10 x 8) and aux.exr (four times that), the frame of most tests.
struct SmallFrame {
  TemporaryFolder folder;
  std::string color = (folder / "colour.exr").string(), aux = (folder / "aux.exr").string(),
              out = (folder / "out.exr").string();
  SmallFrame();
  /// The arguments of a run, with a small model of scale 4 unless another one is given, and some more.
  std::vector<std::string> arguments(const std::vector<std::string>& more = {}, const std::string& model = "") const;
};

std::string goldenModel(const std::string& name);
/// Networks of random weights in the place of those that `xrds import oidn` puts into such a folder, which is made:
/// of the colour alone, the colour with guides, albedo and normal.
void writeDenoisers(const std::filesystem::path& folder);
ExrPart headerOf(const std::string& path);
Image readColour(const std::string& path);

/// Expects an exit code, one sentence with `words` on stderr, and `fileCount` files in the folder: nothing left behind.
void expectFailure(const Ended& ended, int exitCode, const std::string& words, const TemporaryFolder& folder,
                   size_t fileCount);

}  // namespace xrds::test
