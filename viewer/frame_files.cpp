#include "viewer/frame_files.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "image/aov.h"
#include "image/repair.h"
#include "xrds/error.h"

namespace xrds {
namespace fs = std::filesystem;
namespace {

/// A pattern with a run of '#': what stands before and after it, and its length.
struct Numbered {
  std::string before, after;
  size_t digits = 0;

  explicit Numbered(const std::string& name) {
    const size_t first = name.find('#'), end = std::min(name.find_first_not_of('#', first), name.size());
    before = name.substr(0, first);
    after = name.substr(end);
    digits = end - first;
  }
  // The number in a name that fits, as text without leading zeros; nothing if it does not fit.
  std::optional<long long> numberIn(const std::string& name) const {
    if (name.size() < before.size() + after.size() + digits || !name.starts_with(before) || !name.ends_with(after))
      return std::nullopt;
    const std::string middle = name.substr(before.size(), name.size() - before.size() - after.size());
    const bool number = std::all_of(middle.begin(), middle.end(), [](unsigned char c) { return std::isdigit(c); });
    if (!number || middle.size() > 18) return std::nullopt;
    return std::stoll(middle);
  }
};

std::map<long long, fs::path> numberedFiles(const fs::path& pattern) {
  const Numbered numbered(pattern.filename().string());
  const fs::path folder = pattern.parent_path().empty() ? "." : pattern.parent_path();
  std::map<long long, fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (const auto number = numbered.numberIn(entry.path().filename().string())) files[*number] = entry.path();
  return files;
}

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
  Image reference = readLayer(file, findAov(file, AovRole::kColor));
  repairNonFinite(reference);
  return reference;
}

void addReference(LoadedFrame& frame) {
  Image reference = readReferenceOf(frame);
  const int scale = reference.width / frame.colour.width;
  if (frame.scale == 0) frame.scale = scale;
  if (reference.width != frame.scale * frame.colour.width || reference.height != frame.scale * frame.colour.height)
    throw Error("The reference '" + frame.files.reference.string() + "' has " + std::to_string(reference.width) +
                " x " + std::to_string(reference.height) + " pixels, which does not fit a frame of " +
                std::to_string(frame.colour.width) + " x " + std::to_string(frame.colour.height) + ".");
  frame.reference = std::move(reference);
}

}  // namespace

LoadedFrame loadFrame(const FrameFiles& files, const AovRequest& layers, const MergeRequest& merge) {
  LoadedFrame loaded;
  loaded.files = files;
  loaded.inputs = inputsOf(files, layers);
  Frame frame(files.colour, files.auxiliary, layers, loaded.inputs, merge);
  frame.load();
  loaded.colour = frame.colour();
  loaded.auxiliary = frame.auxiliary();
  if (!frame.merged() && !loaded.inputs.empty() && loaded.inputs.back() == kFullColour.name) {
    loaded.inputs.pop_back();  // models that take it expect the merged colour
    loaded.auxiliary.pop_back();
  }
  loaded.scale = frame.scale();
  loaded.warnings = frame.warnings();
  if (frame.merged()) loaded.warnings.push_back(describe(*frame.merged()));
  if (!files.reference.empty()) addReference(loaded);
  loaded.output = frame.output(std::max(loaded.scale, 1));
  return loaded;
}

FrameFiles newestFrame(const fs::path& folder) {
  constexpr size_t kMost = 12;  // renderers keep old frames: only the latest files are looked at
  std::vector<fs::directory_entry> entries;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".exr" && entry.is_regular_file(error)) entries.push_back(entry);
  std::sort(entries.begin(), entries.end(), [&](const auto& a, const auto& b) {
    const auto timeA = a.last_write_time(error), timeB = b.last_write_time(error);
    return timeA != timeB ? timeA > timeB : a.path() < b.path();
  });
  std::vector<ExrFile> headers;
  for (size_t i = 0; i < std::min(entries.size(), kMost); ++i) headers.push_back(readExrHeader(entries[i].path()));
  if (headers.empty()) throw Error("The folder '" + folder.string() + "' holds no EXR file yet.");
  return sortHeaders(headers);
}

bool isSequence(const fs::path& pattern) { return pattern.filename().string().find('#') != std::string::npos; }

std::vector<FrameFiles> sequenceOf(const FrameFiles& patterns) {
  std::map<long long, FrameFiles> frames;
  for (const auto& [number, path] : numberedFiles(patterns.colour)) frames[number].colour = path;
  if (frames.empty())
    throw Error("No file fits the sequence '" + patterns.colour.string() + "': '#' stands for the digits of a number.");
  const auto add = [&](const fs::path& pattern, fs::path FrameFiles::*member) {
    if (pattern.empty()) return;
    const auto files = isSequence(pattern) ? numberedFiles(pattern) : std::map<long long, fs::path>{};
    for (auto& [number, frame] : frames) {
      const auto found = files.find(number);
      if (isSequence(pattern) && found == files.end())
        throw Error("The sequence '" + pattern.string() + "' has no frame " + std::to_string(number) + ", which '" +
                    patterns.colour.string() + "' has.");
      frame.*member = isSequence(pattern) ? found->second : pattern;
    }
  };
  add(patterns.auxiliary, &FrameFiles::auxiliary);
  add(patterns.reference, &FrameFiles::reference);
  std::vector<FrameFiles> ordered;
  for (auto& [number, frame] : frames) ordered.push_back(std::move(frame));
  return ordered;
}

}  // namespace xrds
