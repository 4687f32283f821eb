// Files as their headers would list them, for the tests of this folder.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "image/exr/file.h"
#include "xrds/error.h"

namespace xrds::test {

constexpr Box kLow{0, 0, 63, 47};
constexpr Box kHigh{0, 0, 255, 191};

using Names = std::vector<std::string>;

// A part as a file's headers would list it; channels in alphabetical order as OpenEXR keeps them.
inline ExrPart partWith(Names channels, const Box& box = kLow, const std::string& name = "",
                        ExrPixelType type = ExrPixelType::kHalf) {
  std::sort(channels.begin(), channels.end());
  ExrPart part;
  part.name = name;
  part.dataWindow = box;
  part.displayWindow = box;
  for (const std::string& channel : channels) {
    const size_t dot = channel.rfind('.');
    const std::string layer = dot == std::string::npos ? "" : channel.substr(0, dot);
    const std::string suffix = dot == std::string::npos ? channel : channel.substr(dot + 1);
    auto found =
        std::find_if(part.layers.begin(), part.layers.end(), [&](const ExrLayer& l) { return l.name == layer; });
    if (found == part.layers.end()) {
      found = part.layers.insert(part.layers.end(), ExrLayer{layer, {}});
    }
    found->channels.push_back({channel, suffix, type, 1, 1});
  }
  return part;
}

inline ExrFile fileWith(std::vector<ExrPart> parts) {
  ExrFile file;
  file.path = "frame.exr";
  file.parts = std::move(parts);
  return file;
}

inline Names triple(const std::string& layer, const char* suffixes) {
  const std::string start = layer.empty() ? "" : layer + ".";
  return {start + suffixes[0], start + suffixes[1], start + suffixes[2]};
}

inline Names operator+(Names a, const Names& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

inline const Names kRoot = triple("", "RGB");
inline const Names kCyclesAux =
    triple("ViewLayer.Denoising Albedo", "RGB") + triple("ViewLayer.Denoising Normal", "XYZ");
inline const Names kCycles = triple("ViewLayer.Combined", "RGB") + Names{"ViewLayer.Combined.A", "ViewLayer.Depth.Z"} +
                             kCyclesAux + triple("ViewLayer.CryptoObject00", "rgb") +
                             triple("ViewLayer.Normal", "XYZ") + triple("ViewLayer.DiffCol", "RGB") +
                             Names{"ViewLayer.Denoising Depth.Z"};

// The message of the Error that `find` must throw.
template <typename Find>
std::string refusal(Find&& find) {
  try {
    find();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

}  // namespace xrds::test
