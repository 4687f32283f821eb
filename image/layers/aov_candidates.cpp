#include "image/layers/aov_candidates.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <initializer_list>
#include <utility>

namespace xrds {
namespace {

using Triple = std::array<std::string_view, 3>;

constexpr Triple kRgb = {"r", "g", "b"};
constexpr Triple kWords = {"red", "green", "blue"};
constexpr Triple kXyz = {"x", "y", "z"};

const ExrChannel* findChannel(const ExrLayer& layer, const std::string& plainSuffix) {
  const auto found = std::find_if(layer.channels.begin(), layer.channels.end(), [&](const ExrChannel& channel) {
    return plainName(channel.suffix) == plainSuffix && channel.type != ExrPixelType::kUint && channel.xSampling == 1 &&
           channel.ySampling == 1;
  });
  return found == layer.channels.end() ? nullptr : &*found;
}

// The full names of the channels `start` + triple; empty unless all three are there.
std::vector<std::string> findTriple(const ExrLayer& layer, const Triple& triple, const std::string& start = "") {
  std::vector<std::string> names;
  for (const std::string_view suffix : triple) {
    const ExrChannel* channel = findChannel(layer, start + std::string(suffix));
    if (channel == nullptr) {
      return {};
    }
    names.push_back(channel->name);
  }
  return names;
}

bool hasAnyOf(const ExrLayer& layer, std::initializer_list<std::string_view> plainSuffixes) {
  return std::any_of(layer.channels.begin(), layer.channels.end(), [&](const ExrChannel& channel) {
    const std::string suffix = plainName(channel.suffix);
    return std::find(plainSuffixes.begin(), plainSuffixes.end(), suffix) != plainSuffixes.end();
  });
}

std::vector<std::string> findTriple(const ExrLayer& layer, AovRole role) {
  std::vector<const Triple*> order = {&kRgb, &kWords};
  const bool mayBeGrey = role == AovRole::kColor || role == AovRole::kFullColor || role == AovRole::kAlbedo;
  if (role == AovRole::kNormal) {
    order.insert(order.begin(), &kXyz);
  } else if (role == AovRole::kAlbedo) {
    order.push_back(&kXyz);
  }
  for (const Triple* triple : order) {
    std::vector<std::string> names = findTriple(layer, *triple);
    if (!names.empty()) {
      return names;
    }
  }
  if (const ExrChannel* grey = mayBeGrey ? greyChannel(layer) : nullptr) {
    return {3, grey->name};
  }
  return {};
}

std::pair<std::string, std::string> splitAtLastDot(const std::string& name) {
  const size_t dot = name.rfind('.');
  return dot == std::string::npos ? std::pair<std::string, std::string>{"", name}
                                  : std::pair(name.substr(0, dot), name.substr(dot + 1));
}

// Those that share its parts, or those of its parts; the default one first.
std::vector<std::string> viewsOf(const ExrFile& file) {
  std::vector<std::string> views = file.views;
  for (const ExrPart& part : file.parts) {
    const bool isNew = !part.view.empty() && std::find(views.begin(), views.end(), part.view) == views.end();
    if (file.views.empty() && isNew) {
      views.push_back(part.view);
    }
  }
  return views;
}

// Layers of one channel, as "ViewLayer.Depth.Z", and channels without a layer's name, as "Z".
std::vector<AovCandidate> depthCandidates(const ExrFile& file, size_t number) {
  std::vector<AovCandidate> result;
  for (const ExrLayer& layer : file.parts[number].layers) {
    for (const ExrChannel& channel : layer.channels) {
      if (findChannel(layer, plainName(channel.suffix)) != &channel) {
        continue;
      }
      if (!layer.name.empty() && layer.channels.size() == 1) {
        result.push_back(candidateOf(file, number, layer, {channel.name}, layer.name));
      } else if (layer.name.empty() && aovRank(AovRole::kDepth, channel.suffix)) {
        result.push_back(candidateOf(file, number, layer, {channel.name}, channel.name));
      }
    }
  }
  return result;
}

}  // namespace

const ExrChannel* greyChannel(const ExrLayer& layer) {
  return hasAnyOf(layer, {"x", "r", "g", "b", "red", "green", "blue", "ry", "by"}) ? nullptr : findChannel(layer, "y");
}

bool hasChroma(const ExrLayer& layer) { return hasAnyOf(layer, {"y"}) && hasAnyOf(layer, {"ry", "by"}); }

std::string takeView(const ExrFile& file, std::string& layerName) {
  const auto [rest, last] = splitAtLastDot(layerName);
  const std::vector<std::string> views = viewsOf(file);
  if (std::find(views.begin(), views.end(), last) == views.end()) {
    return "";
  }
  layerName = rest;
  return last;
}

bool isOtherView(const ExrFile& file, const std::string& view) {
  const std::vector<std::string> views = viewsOf(file);
  return !view.empty() && !views.empty() && view != views.front();
}

std::vector<AovCandidate> aovCandidates(const ExrFile& file, AovRole role) {
  std::vector<AovCandidate> result;
  for (size_t number = 0; number < file.parts.size(); ++number) {
    if (file.parts[number].deep) {
      continue;
    }
    if (role == AovRole::kDepth) {
      const auto depths = depthCandidates(file, number);
      result.insert(result.end(), depths.begin(), depths.end());
      continue;
    }
    for (const ExrLayer& layer : file.parts[number].layers) {
      if (auto names = findTriple(layer, role); !names.empty()) {
        result.push_back(candidateOf(file, number, layer, std::move(names), layer.name));
      }
      // pbrt wrote Nsx, Nsy, Nsz without a dot until 2023.
      if (role == AovRole::kNormal && layer.name.empty()) {
        for (const char* stem : {"Ns", "N"}) {
          if (auto names = findTriple(layer, kXyz, plainName(stem)); !names.empty()) {
            result.push_back(candidateOf(file, number, layer, std::move(names), stem));
          }
        }
      }
    }
  }
  return result;
}

AovCandidate candidateOf(const ExrFile& file, size_t number, const ExrLayer& layer,
                         std::vector<std::string> channelNames, const std::string& ownName) {
  const ExrPart& part = file.parts[number];
  AovCandidate candidate;
  std::string name = ownName;
  candidate.view = takeView(file, name);
  candidate.namedByPart = name.empty() && file.parts.size() > 1 && part.layers.size() == 1 && !part.name.empty();
  if (candidate.namedByPart) {
    name = part.name;
    takeView(file, name);
  }
  candidate.selection = {number, name.empty() ? "(unnamed)" : name, std::move(channelNames)};
  if (!candidate.view.empty()) {
    candidate.selection.layer += "." + candidate.view;
  }
  std::tie(candidate.prefix, candidate.stem) = splitAtLastDot(name);
  if (candidate.view.empty()) {
    candidate.view = part.view;
  }
  if (!isOtherView(file, candidate.view)) {
    candidate.view.clear();
  }
  candidate.pixelCount = part.dataWindow.width() * part.dataWindow.height();
  for (const char* suffix : {"a", "alpha"}) {
    if (const ExrChannel* alpha = findChannel(layer, suffix); alpha != nullptr && !candidate.alpha) {
      candidate.alpha = ExrSelection{number, candidate.selection.layer, {alpha->name}};
    }
  }
  return candidate;
}

void keepIf(std::vector<AovCandidate>& candidates, const std::function<bool(const AovCandidate&)>& wanted) {
  std::erase_if(candidates, [&](const AovCandidate& candidate) { return !wanted(candidate); });
}

void preferIf(std::vector<AovCandidate>& candidates, const std::function<bool(const AovCandidate&)>& wanted) {
  if (std::any_of(candidates.begin(), candidates.end(), wanted)) {
    keepIf(candidates, wanted);
  }
}

bool isUnnamed(const AovCandidate& candidate) { return candidate.stem.empty() && candidate.prefix.empty(); }

std::vector<AovCandidate> namedBy(const ExrFile& file, std::vector<AovCandidate> candidates, std::string name) {
  size_t part = 0;
  const char* end = name.data() + name.size();
  const auto [rest, failure] = std::from_chars(name.data(), end, part);
  if (failure == std::errc() && rest != end && *rest == ':') {
    keepIf(candidates, [&](const AovCandidate& c) { return c.selection.part == part; });
    name.erase(0, static_cast<size_t>(rest - name.data()) + 1);
  }
  const std::string plain = plainName(name);
  const bool meansUnnamed = plain.empty() || plain == "(unnamed)" || plain == "rgb" || plain == "rgba";
  const auto partName = [&](const AovCandidate& c) { return file.parts[c.selection.part].name; };
  const std::function<bool(const AovCandidate&)> readings[] = {
      [&](const AovCandidate& c) { return c.selection.layer == name; },
      [&](const AovCandidate& c) { return plainName(c.selection.layer) == plain; },
      [&](const AovCandidate& c) { return !name.empty() && partName(c) == name; },
      [&](const AovCandidate& c) { return !name.empty() && plainName(c.stem) == plain; },
      [&](const AovCandidate& c) { return meansUnnamed && (isUnnamed(c) || c.namedByPart); },
      [&](const AovCandidate& c) { return !name.empty() && c.view == name && (isUnnamed(c) || c.namedByPart); }};
  for (const auto& reading : readings) {
    std::vector<AovCandidate> matching = candidates;
    keepIf(matching, reading);
    if (!matching.empty()) {
      return matching;
    }
  }
  return {};
}

std::string placesOf(const std::vector<AovCandidate>& candidates) {
  std::string list;
  for (const AovCandidate& candidate : candidates) {
    list += (list.empty() ? "" : ", ") + std::to_string(candidate.selection.part) + ":" +
            printable(candidate.selection.layer);
  }
  return list;
}

}  // namespace xrds
