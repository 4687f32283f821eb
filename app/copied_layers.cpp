#include "app/copied_layers.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "image/layers/aov_candidates.h"
#include "image/layers/light_names.h"

namespace xrds {
namespace {

bool isColour(const ExrChannel& channel) {
  constexpr std::string_view kSuffixes[] = {"r", "g", "b", "a", "red", "green", "blue", "alpha"};
  return std::find(std::begin(kSuffixes), std::end(kSuffixes), plainName(channel.suffix)) != std::end(kSuffixes);
}

bool isSubsampled(const ExrChannel& channel) { return channel.xSampling != 1 || channel.ySampling != 1; }

bool isNamedByPart(const ExrFile& file, const ExrPart& part) {
  return file.parts.size() > 1 && part.layers.size() == 1 && part.layers.front().name.empty() && !part.name.empty();
}

std::string outputName(const ExrFile& file, size_t number, const std::string& channel) {
  const ExrPart& part = file.parts[number];
  return isNamedByPart(file, part) ? part.name + "." + channel : channel;
}

template <class Range, class Value>
bool contains(const Range& range, const Value& value) {
  return std::find(std::begin(range), std::end(range), value) != std::end(range);
}

/// Copies layer by layer, and keeps what names of channels are taken.
class Copying {
 public:
  /// Of parts that lie as the part `wanted` does.
  Copying(const ExrFile& file, size_t wanted, const Box& window, const MadeLayers& made)
      : file_(file),
        wanted_(file.parts[wanted].dataWindow),
        window_(window),
        made_(made),
        taken_(made.channels.begin(), made.channels.end()) {}

  void addPart(size_t number) {
    const size_t before = copied_.planes.size();
    for (const ExrLayer& layer : file_.parts[number].layers) addLayer(number, layer);
    if (copied_.planes.size() > before) copied_.attributes.push_back(file_.parts[number].attributes);
  }

  CopiedLayers finish() {
    for (const auto& [reason, names] : leftOut_) copied_.leftOut.push_back(names + " (" + reason + ")");
    return std::move(copied_);
  }

 private:
  void addLayer(size_t number, const ExrLayer& layer) {
    const ExrPart& part = file_.parts[number];
    std::string name = isNamedByPart(file_, part) ? part.name : layer.name;
    std::string view = takeView(file_, name);
    if (view.empty()) view = part.view;
    const std::string own = name.substr(name.rfind('.') + 1);
    std::vector<const ExrChannel*> left;
    for (const ExrChannel& channel : layer.channels)
      if (!isMade(number, channel)) left.push_back(&channel);
    if (left.empty()) return;
    const std::string shown = !own.empty()       ? printable(own)
                              : left.size() == 1 ? printable(left.front()->name)
                                                 : "(unnamed)";
    const std::string why = whyLeftOut(part, view, left);
    if (!why.empty()) return leaveOut(shown, why);
    const bool isWhole = left.size() == layer.channels.size();
    if (isWhole && isLight(own)) return leaveOut(shown, whyNoLight(own));
    // Channels that stand beside a colour, such as Z, are none of it.
    const ExrChannel* const grey = greyChannel(layer);
    if (isWhole && aovRank(AovRole::kColor, own) &&
        (grey || std::count_if(left.begin(), left.end(), isColourAt) >= 3)) {
      std::erase_if(left, [&](const ExrChannel* channel) { return channel == grey || isColourAt(channel); });
      leaveOut(shown, "another colour");
    }
    copy(number, shown, left);
  }

  static bool isColourAt(const ExrChannel* channel) { return isColour(*channel); }

  std::string whyNoLight(const std::string& own) const {
    return contains(made_.lights, own) ? "light that --layers does not name"
                                       : "light that the colour's render lacks, or of another view layer";
  }

  std::string whyLeftOut(const ExrPart& part, const std::string& view,
                         const std::vector<const ExrChannel*>& channels) const {
    if (part.deep) return "deep";
    if (part.dataWindow != wanted_) return "of another data window";
    if (isOtherView(file_, view)) return "of another view";
    if (std::any_of(channels.begin(), channels.end(), [](const ExrChannel* c) { return isSubsampled(*c); }))
      return "subsampled";
    return "";
  }

  bool isMade(size_t number, const ExrChannel& channel) const {
    if (contains(made_.channels, outputName(file_, number, channel.name))) return true;
    return std::any_of(made_.sources.begin(), made_.sources.end(), [&](const ExrSelection& source) {
      return source.part == number && contains(source.channelNames, channel.name);
    });
  }

  void leaveOut(const std::string& name, const std::string& why) {
    std::string& names = leftOut_[why];
    names += (names.empty() ? "" : ", ") + name;
  }

  void copy(size_t number, const std::string& shown, const std::vector<const ExrChannel*>& channels) {
    ExrSelection wanted{number, {}, {}};
    for (const ExrChannel* channel : channels)
      if (taken_.insert(outputName(file_, number, channel->name)).second) wanted.channelNames.push_back(channel->name);
    if (wanted.channelNames.size() < channels.size()) leaveOut(shown, "another part has channels of its names");
    if (wanted.channelNames.empty()) return;
    std::vector<ExrPlane> planes = readPlanes(file_, number, wanted.channelNames, window_);
    const std::vector<std::string> names = outputNames(file_, wanted);
    for (size_t c = 0; c < planes.size(); ++c) planes[c].name = names[c];
    std::move(planes.begin(), planes.end(), std::back_inserter(copied_.planes));
    copied_.names.push_back(shown);
  }

  const ExrFile& file_;
  const Box wanted_, window_;
  const MadeLayers& made_;
  std::set<std::string> taken_;                 // names of channels of the output
  std::map<std::string, std::string> leftOut_;  // by the reason
  CopiedLayers copied_;
};

}  // namespace

std::vector<std::string> outputNames(const ExrFile& file, const ExrSelection& layer) {
  std::vector<std::string> names;
  for (const std::string& name : layer.channelNames) names.push_back(outputName(file, layer.part, name));
  if (layer.isGrey())  // it becomes a layer of colour
    for (const size_t c : {0, 1, 2}) names[c].back() = "RGB"[c];
  return names;
}

CopiedLayers copyLayers(const ExrFile& file, size_t wanted, const Box& window, const MadeLayers& made) {
  Copying copying(file, wanted, window, made);
  for (size_t number = 0; number < file.parts.size(); ++number) copying.addPart(number);
  return copying.finish();
}

}  // namespace xrds
