#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "image/aov.h"
#include "image/exr_write.h"
#include "image/image.h"
#include "xrds/xrds.h"

namespace xrds {

/// The layers of a frame to upscale, found in one or two EXR files, with what the output must keep.
class Frame {
 public:
  /// Reads headers only. An empty auxPath means the colour's file. Throws Error if the layers are not found or the
  /// sizes are no whole multiple of each other. `model` may be empty to find the scale first: then albedo and normal
  /// are optional.
  Frame(const std::filesystem::path& colorPath, const std::filesystem::path& auxPath, const AovRequest& request,
        const std::vector<std::string>& auxiliaryInputs);

  int scale() const { return scale_; }  // 0 if no auxiliary layer tells it
  uint32_t width() const { return static_cast<uint32_t>(window_.width()); }
  uint32_t height() const { return static_cast<uint32_t>(window_.height()); }
  const ExrPart& colorPart() const { return colorFile_.parts[aovs_.color.part]; }

  /// Reads and repairs the pixels; what was repaired or looks wrong is added to warnings(). Throws Error.
  void load();

  const Image& colour() const { return colour_; }
  const std::optional<Image>& alpha() const { return alpha_; }
  const std::vector<Image>& auxiliary() const { return auxiliary_; }  // in the order of the model's inputs
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  Image loadAuxiliary(const std::string& input);

  ExrFile colorFile_, auxFile_;
  std::vector<std::string> inputs_;
  Aovs aovs_;
  Window window_;
  int scale_ = 0;
  Image colour_;
  std::optional<Image> alpha_;
  std::vector<Image> auxiliary_;
  std::vector<std::string> warnings_;
};

/// The pixels as the library takes them.
PixelView viewOf(const Image& image);
std::vector<PixelView> viewsOf(const std::vector<Image>& images);

/// The scale between the colour and the auxiliary images of two files, from their windows alone; 0 if there is no
/// auxiliary layer.
int findScale(const std::filesystem::path& colorPath, const std::filesystem::path& auxPath, AovRequest request);

}  // namespace xrds
