#include "app/copied_layers.h"

#include <algorithm>
#include <iterator>

#include "image/aov_names.h"
#include "image/light_names.h"

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

// Why a layer is not copied; empty: it is.
std::string whyLeftOut(const ExrFile& file, const ExrPart& part, const ExrLayer& layer, const std::string& own) {
  if (part.deep) return "deep";
  if (!part.view.empty() && !file.views.empty() && part.view != file.views.front()) return "of another view";
  if (lightName(own).kind != LightName::Kind::none)
    return "light that the colour's render lacks, or of another view layer";
  if (std::any_of(layer.channels.begin(), layer.channels.end(), isSubsampled)) return "subsampled";
  return "";
}

}  // namespace

std::vector<std::string> outputNames(const ExrFile& file, const ExrSelection& layer) {
  const ExrPart& part = file.parts[layer.part];
  std::vector<std::string> names;
  for (const std::string& name : layer.channelNames)
    names.push_back(isNamedByPart(file, part) ? part.name + "." + name : name);
  return names;
}

CopiedLayers copyLayers(const ExrFile& file, size_t wanted, const Box& window,
                        const std::vector<std::string>& upscaled) {
  CopiedLayers copied;
  for (size_t number = 0; number < file.parts.size(); ++number) {
    const ExrPart& part = file.parts[number];
    if (part.dataWindow != file.parts[wanted].dataWindow) continue;
    for (const ExrLayer& layer : part.layers) {
      const std::string name = isNamedByPart(file, part) ? part.name : layer.name;
      const std::string own = name.substr(name.rfind('.') + 1);
      if (std::find(upscaled.begin(), upscaled.end(), own) != upscaled.end()) continue;
      const std::string why = whyLeftOut(file, part, layer, own);
      if (!why.empty()) {
        copied.leftOut.push_back(printable(own) + " (" + why + ")");
        continue;
      }
      // A colour is what is upscaled; channels that stand beside it, such as Z, are not.
      const bool holdsColour =
          aovRank(AovRole::kColor, own) && std::count_if(layer.channels.begin(), layer.channels.end(), isColour) >= 3;
      ExrSelection channels{number, name, {}};
      for (const ExrChannel& channel : layer.channels)
        if (!holdsColour || !isColour(channel)) channels.channelNames.push_back(channel.name);
      if (channels.channelNames.empty()) continue;
      std::vector<ExrPlane> planes = readPlanes(file, number, channels.channelNames, window);
      const std::vector<std::string> names = outputNames(file, channels);
      for (size_t c = 0; c < planes.size(); ++c) planes[c].name = names[c];
      std::move(planes.begin(), planes.end(), std::back_inserter(copied.planes));
      copied.names.push_back(printable(own.empty() ? channels.channelNames.front() : own));
    }
  }
  return copied;
}

}  // namespace xrds
