#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/frame.h"
#include "app/frame_files.h"
#include "image/image.h"

namespace xrds {

/// A frame in the host's memory, ready to be upscaled.
struct LoadedFrame {
  FrameFiles files;
  Image colour;
  std::vector<std::string> inputs;      // "albedo", "normal": as many as the files have
  std::vector<Image> auxiliary;         // one for each of inputs
  std::optional<Image> unmergedColour;  // of the full-resolution render, where it is not among the auxiliary images
  std::optional<Image> reference;       // of the size of the auxiliary images
  int scale = 0;                        // of the auxiliary images or the reference over the colour; 0: neither is there
  ExrOutput output;                     // windows and attributes of the upscaled frame; of the colour's if scale is 0
  std::vector<std::string> warnings;
  std::optional<double> samples;  // of a pixel of the colour, where they are known
  size_t merged = 1;              // frames of a sequence that it is made of
  std::string constant;           // which input is the same everywhere (constantInput()), of a sequence in all frames
};

/// A frame with all that its files have of what models take, its pixels read. Throws Error if a file cannot be read or
/// they do not fit together.
Frame readFrame(const FrameFiles& files, const AovRequest& layers, const MergeRequest& merge = {});

/// The same to be upscaled, with the reference of its files. Throws Error if that does not fit.
LoadedFrame loadedFrame(const FrameFiles& files, const Frame& frame);

/// Reads a frame. Throws Error if a file cannot be read or they do not fit together.
LoadedFrame loadFrame(const FrameFiles& files, const AovRequest& layers, const MergeRequest& merge = {});

/// The frame that a renderer wrote last into a folder: its newest colour, auxiliary and reference file. Older files
/// that are damaged are left out. Throws Error if the folder holds no EXR file, or the newest cannot be read.
FrameFiles newestFrame(const std::filesystem::path& folder);

/// Whether the name stands for a numbered sequence (sequence/file_pattern.h): it has a run of '#' or %04d.
bool isSequence(const std::filesystem::path& pattern);

/// A frame of a sequence.
struct NumberedFiles {
  int number = 0;
  FrameFiles files{};
};
using Sequence = std::vector<NumberedFiles>;

/// The frame of that number; null if there is none.
const FrameFiles* filesOf(const Sequence& sequence, int number);

/// Which input is the same everywhere in the first frame that can be read (constantInput()), where one is so in the
/// middle and the last frame, too: one that shows nothing does not speak for the others. Empty if none is.
std::string constantInput(const Sequence& sequence, const AovRequest& layers);

/// Tells the patterns of colour, auxiliary images and reference apart, in whichever order they are given, by the files
/// of the first frame that can be read (sortFiles()). They stay in their order if these hold no auxiliary images.
FrameFiles sortPatterns(const std::vector<std::filesystem::path>& patterns);

/// The frames of a sequence in the order of their numbers, of those patterns that are given: "shot.####.exr" stands for
/// every file whose name has a number of at least four digits there. A name without a field is the same file for each
/// frame. Throws Error if there is no frame, or a file of one is missing.
Sequence sequenceOf(const FrameFiles& patterns);

}  // namespace xrds
