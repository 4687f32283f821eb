#include "image/exr/attributes.h"

#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <utility>

#include "image/exr/attributes_stored.h"
#include "image/leading_number.h"

namespace xrds {

ExrAttributes::ExrAttributes() : stored_(std::make_unique<Stored>()) {}
ExrAttributes::ExrAttributes(std::unique_ptr<Stored> stored) : stored_(std::move(stored)) {}
ExrAttributes::ExrAttributes(const ExrAttributes& other) : stored_(std::make_unique<Stored>(*other.stored_)) {}
ExrAttributes::ExrAttributes(ExrAttributes&& other) noexcept = default;
ExrAttributes::~ExrAttributes() = default;

ExrAttributes& ExrAttributes::operator=(ExrAttributes other) noexcept {
  stored_ = std::move(other.stored_);
  return *this;
}

std::vector<std::string> ExrAttributes::names() const {
  std::vector<std::string> result;
  for (auto entry = stored_->header.begin(); entry != stored_->header.end(); ++entry) {
    if (describesPicture(entry.name())) {
      result.emplace_back(entry.name());
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

std::optional<std::string> ExrAttributes::text(const std::string& name) const {
  const auto* attribute = stored_->header.findTypedAttribute<Imf::StringAttribute>(name);
  return attribute == nullptr ? std::nullopt : std::optional(attribute->value());
}

std::optional<double> ExrAttributes::number(const std::string& name) const {
  const Imf::Header& header = stored_->header;
  if (const auto* whole = header.findTypedAttribute<Imf::IntAttribute>(name)) return whole->value();
  if (const auto* single = header.findTypedAttribute<Imf::FloatAttribute>(name)) return single->value();
  if (const auto* twofold = header.findTypedAttribute<Imf::DoubleAttribute>(name)) return twofold->value();
  const std::optional<std::string> written = text(name);
  const auto found = written ? leadingNumber(written->data(), written->data() + written->size()) : std::nullopt;
  return found ? std::optional(found->value) : std::nullopt;
}

std::optional<std::array<float, 16>> ExrAttributes::matrix(const std::string& name) const {
  const auto* attribute = stored_->header.findTypedAttribute<Imf::M44fAttribute>(name);
  if (attribute == nullptr) return std::nullopt;
  std::array<float, 16> numbers{};
  std::copy_n(attribute->value().getValue(), numbers.size(), numbers.begin());
  return numbers;
}

bool describesPicture(std::string_view attributeName) {
  static constexpr std::array<std::string_view, 18> kEncoding = {
      "BlenderMultiChannel",
      "channels",
      "chunkCount",
      "compression",
      "dataWindow",
      "deepImageState",
      "displayWindow",
      "dwaCompressionLevel",
      "lineOrder",
      "maxSamplesPerPixel",
      "multiView",
      "name",
      "preview",
      "tiles",
      "type",
      "version",
      "view",
      "zipCompressionLevel",
  };
  return std::find(kEncoding.begin(), kEncoding.end(), attributeName) == kEncoding.end() &&
         attributeName != kMergedWithout && !attributeName.starts_with("cryptomatte/");
}

bool describesLayers(std::string_view attributeName) {
  return attributeName.starts_with("cryptomatte/") || attributeName == "BlenderMultiChannel";
}

ExrAttributes attributesOf(const Imf::Header& header) {
  return ExrAttributes(std::make_unique<ExrAttributes::Stored>(ExrAttributes::Stored{header}));
}

}  // namespace xrds
