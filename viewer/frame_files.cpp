#include "viewer/frame_files.h"

#include <algorithm>

#include "app/constant_input.h"
#include "image/layers/aov.h"
#include "image/repair.h"
#include "sequence/file_pattern.h"
#include "xrds/error.h"

namespace xrds {
namespace fs = std::filesystem;
namespace {

constexpr fs::path FrameFiles::*kKinds[] = {&FrameFiles::colour, &FrameFiles::auxiliary, &FrameFiles::reference};

// Whether the files hold a depth that goes with their albedo, or a layer was named for it.
bool hasDepth(const FrameFiles& files, const AovRequest& layers) {
  try {
    const Frame frame(files.colour, files.auxiliary, layers, {std::string(kAlbedo.name), std::string(kDepth.name)});
    return true;
  } catch (const Error&) {
    return !layers.nameOf(AovRole::kDepth).empty();
  }
}

// The auxiliary inputs that the files have, of those that a model may want: models change while a frame is shown.
std::vector<std::string> inputsOf(const FrameFiles& files, const AovRequest& layers) {
  const ExrFile file = readExrHeader(files.auxiliary.empty() ? files.colour : files.auxiliary);
  std::vector<std::string> inputs;
  for (const AuxiliaryInput& input : kAuxiliaryInputs) {
    const AovRole role = roleOf(input.name);
    const bool there = input.isDistance              ? hasDepth(files, layers)
                       : role == AovRole::kFullColor ? hasFullColour(files.colour, files.auxiliary, layers)
                                                     : !layers.nameOf(role).empty() || hasAov(file, role);
    if (there) inputs.emplace_back(input.name);
  }
  return inputs;
}

Image readReferenceOf(const LoadedFrame& frame) {
  const ExrFile file = readExrHeader(frame.files.reference);
  Image reference = readLayer(file, findAov(file, AovRole::kColor, "", ""));
  repairNonFinite(reference);
  return reference;
}

std::string sizeOf(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

void addReference(LoadedFrame& frame) {
  Image reference = readReferenceOf(frame);
  const int width = frame.colour.width, height = frame.colour.height;
  const bool isKnown = frame.scale > 0;
  if (!isKnown) frame.scale = reference.width / width;
  if (reference.width != frame.scale * width || reference.height != frame.scale * height)
    throw Error("The reference '" + frame.files.reference.string() + "' has " +
                sizeOf(reference.width, reference.height) + " pixels, not " +
                (isKnown ? sizeOf(frame.scale * width, frame.scale * height) + " as the result has."
                         : "a multiple of the colour's " + sizeOf(width, height) + "."));
  frame.reference = std::move(reference);
}

}  // namespace

Frame readFrame(const FrameFiles& files, const AovRequest& layers, const MergeRequest& merge) {
  Frame frame(files.colour, files.auxiliary, layers, inputsOf(files, layers), merge);
  frame.load();
  return frame;
}

LoadedFrame loadedFrame(const FrameFiles& files, const Frame& frame) {
  LoadedFrame loaded;
  loaded.files = files;
  loaded.inputs = frame.inputs();
  loaded.colour = frame.colour();
  loaded.auxiliary = frame.auxiliary();
  if (!frame.merged() && !loaded.inputs.empty() && loaded.inputs.back() == kFullColour.name) {
    loaded.inputs.pop_back();  // models that take it expect the merged colour
    loaded.unmergedColour = std::move(loaded.auxiliary.back());
    loaded.auxiliary.pop_back();
  }
  loaded.scale = frame.scale();
  loaded.samples = frame.lowSamples();
  loaded.constant = constantInput(loaded.inputs, loaded.auxiliary);
  loaded.warnings = frame.warnings();
  if (frame.merged()) loaded.warnings.push_back(describe(*frame.merged()));
  if (!files.reference.empty()) addReference(loaded);
  loaded.output = frame.output(std::max(loaded.scale, 1));
  return loaded;
}

LoadedFrame loadFrame(const FrameFiles& files, const AovRequest& layers, const MergeRequest& merge) {
  return loadedFrame(files, readFrame(files, layers, merge));
}

FrameFiles newestFrame(const fs::path& folder) {
  constexpr size_t kMost = 12;  // renderers keep old frames: only the latest files are looked at
  std::vector<fs::directory_entry> entries;
  std::error_code error, broken;  // the folder, and a link to nowhere in it, say
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (hasExtension(entry->path(), ".exr") && entry->is_regular_file(broken)) entries.push_back(*entry);
  std::sort(entries.begin(), entries.end(), [&](const auto& a, const auto& b) {
    const auto timeA = a.last_write_time(broken), timeB = b.last_write_time(broken);
    return timeA != timeB ? timeA > timeB : a.path() < b.path();
  });
  if (error) throw Error("Cannot read the folder '" + folder.string() + "': " + error.message() + ".");
  std::vector<ExrFile> headers;
  for (size_t i = 0; i < std::min(entries.size(), kMost); ++i) try {
      headers.push_back(readExrHeader(entries[i].path()));
    } catch (const Error&) {
      if (i == 0) throw;  // it may still be written; an older one stays broken
    }
  if (headers.empty()) throw Error("The folder '" + folder.string() + "' holds no EXR file yet.");
  return sortHeaders(headers);
}

bool isSequence(const fs::path& pattern) {
  std::error_code ignored;
  return !fs::is_directory(pattern, ignored) && FilePattern::mayBeMany(pattern.string());
}

const FrameFiles* filesOf(const Sequence& sequence, int number) {
  const auto found = std::lower_bound(sequence.begin(), sequence.end(), number,
                                      [](const NumberedFiles& frame, int wanted) { return frame.number < wanted; });
  return found != sequence.end() && found->number == number ? &found->files : nullptr;
}

std::string constantInput(const Sequence& sequence, const AovRequest& layers) {
  const auto constantOf = [&](const NumberedFiles& frame) {
    const FrameFiles& files = frame.files;
    std::vector<std::string> inputs = inputsOf(files, layers);
    std::erase_if(inputs, [](const std::string& input) { return input != kAlbedo.name && input != kNormal.name; });
    Frame read(files.colour, files.auxiliary, layers, inputs, {.never = true});
    read.load();
    return constantInput(read.inputs(), read.auxiliary());
  };
  for (const NumberedFiles& frame : sequence) try {
      const std::string input = constantOf(frame);
      const auto hasConstant = [&](size_t i) { return !constantOf(sequence[i]).empty(); };
      return !input.empty() && staysConstant(sequence.size(), hasConstant) ? input : "";
    } catch (const Error&) {
    }
  return "";
}

FrameFiles sortPatterns(const std::vector<fs::path>& patterns) {
  FrameFiles given;
  for (size_t i = 0; i < std::min(patterns.size(), std::size(kKinds)); ++i) given.*kKinds[i] = patterns[i];
  const auto numbered = std::find_if(patterns.begin(), patterns.end(), isSequence);
  for (const int number : FilePattern(numbered->string()).frames()) try {
      std::vector<fs::path> files;
      for (const fs::path& pattern : patterns) files.push_back(FilePattern(pattern.string()).of(number));
      const FrameFiles frame = sortFiles(files);
      FrameFiles sorted;
      for (size_t i = 0; i < patterns.size(); ++i)
        for (const auto kind : kKinds)
          if (files[i] == frame.*kind) sorted.*kind = patterns[i];
      return sorted.auxiliary.empty() ? given : sorted;
    } catch (const Error&) {  // told when its turn comes
    }
  return given;
}

Sequence sequenceOf(const FrameFiles& patterns) {
  const FilePattern colour(patterns.colour.string());
  const std::vector<int> numbers = colour.frames();
  Sequence frames;
  frames.reserve(numbers.size());
  for (const int number : numbers) frames.push_back({number, {.colour = colour.of(number)}});
  if (!colour.isMany())
    throw Error("'" + patterns.colour.string() + "' is one file: the colour of a sequence has '#' for its numbers.");
  if (frames.empty())
    throw Error("No file fits the sequence '" + patterns.colour.string() + "': '#' stands for the digits of a number.");
  const auto add = [&](const fs::path& given, fs::path FrameFiles::*member) {
    if (given.empty()) return;
    const FilePattern pattern(given.string());
    for (auto& [number, files] : frames) {
      files.*member = pattern.of(number);
      if (std::error_code ignored; pattern.isMany() && !fs::exists(files.*member, ignored))
        throw Error("The sequence '" + given.string() + "' has no frame " + std::to_string(number) + ", which '" +
                    patterns.colour.string() + "' has.");
    }
  };
  add(patterns.auxiliary, &FrameFiles::auxiliary);
  add(patterns.reference, &FrameFiles::reference);
  return frames;
}

}  // namespace xrds
