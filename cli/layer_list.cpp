#include "cli/layer_list.h"

#include <cstdio>

#include "app/failing_with.h"
#include "app/merge_request.h"
#include "image/layers/aov.h"

namespace xrds {
namespace {

void printRow(const std::string& name, const std::string& value) {
  std::printf("%-26s %s\n", name.c_str(), value.c_str());
}

std::string shown(const ExrSelection& layer) { return layer.layer.empty() ? "(unnamed)" : printable(layer.layer); }

std::string several(AovRole role) { return "several; " + optionName(role) + " names one"; }

std::string foundFor(const ExrFile& file, AovRole role, const AovPlace& place) {
  if (!hasAov(file, role)) return "none";
  try {
    return shown(findAov(file, role, "", place));
  } catch (const Error&) {
    return several(role);
  }
}

std::string samplesText(const ExrFile& file, const ExrSelection& colour) {
  const std::optional<double> samples = samplesOf({file.parts[colour.part], colour.layer});
  if (!samples) return "not in the file; --samples gives them";
  char text[32];
  std::snprintf(text, sizeof text, "%g", *samples);
  return text;
}

}  // namespace

void printLayers(const std::filesystem::path& path) {
  const ExrFile file = failingWith(ExitCode::input, [&] { return readExrHeader(path); });
  std::printf("%s\n\n", describe(file).c_str());
  AovPlace place;
  std::string samples;
  try {
    const Aovs found = findAovs(file, file, {.needed = {}});
    place = found.place;
    samples = samplesText(file, found.color);
    printRow(toString(AovRole::kColor), shown(found.color));
  } catch (const Error&) {
    printRow(toString(AovRole::kColor), hasAov(file, AovRole::kColor) ? several(AovRole::kColor) : "none");
  }
  for (const AovRole role : {AovRole::kAlbedo, AovRole::kNormal, AovRole::kDepth})
    printRow(toString(role), foundFor(file, role, place));
  if (!samples.empty()) printRow("samples a pixel", samples);
}

}  // namespace xrds
