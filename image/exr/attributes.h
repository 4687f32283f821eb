#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace xrds {

/// The attribute of a merged frame that tells which frames could not be read and so were not merged. It speaks of this
/// one file: none that is made of it has it.
inline constexpr const char* kMergedWithout = "xrds:mergedWithout";

/// What an EXR header says about its picture rather than about its own encoding: camera, frame, colour space and
/// whatever the renderer added. Opaque, so that types which this library does not know travel unharmed; a plain value.
class ExrAttributes {
 public:
  struct Stored;  ///< The OpenEXR side, known to the sources of this folder only.

  /// No attributes.
  ExrAttributes();
  explicit ExrAttributes(std::unique_ptr<Stored> stored);
  ExrAttributes(const ExrAttributes& other);
  ExrAttributes(ExrAttributes&& other) noexcept;
  ExrAttributes& operator=(ExrAttributes other) noexcept;
  ~ExrAttributes();

  /// The names of the attributes in alphabetical order.
  std::vector<std::string> names() const;

  /// The text of a string attribute; nothing when there is none of this name or it is no string.
  std::optional<std::string> text(const std::string& name) const;

  /// The number of an int, float or double attribute, or that with which a string begins; nothing when there is none.
  std::optional<double> number(const std::string& name) const;

  /// The numbers of a 4 x 4 matrix attribute (m44f), row by row; nothing when there is none of this name.
  std::optional<std::array<float, 16>> matrix(const std::string& name) const;

  const Stored& stored() const { return *stored_; }

 private:
  std::unique_ptr<Stored> stored_;
};

}  // namespace xrds
