#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "image/image.h"
#include "image/test_files.h"
#include "tests/cli/process.h"
#include "tests/temporary_folder.h"

namespace xrds::test {

/// An X server without a screen, of its own for each test, as long as this lives.
class VirtualDesktop {
 public:
  VirtualDesktop();
  ~VirtualDesktop();
  VirtualDesktop(const VirtualDesktop&) = delete;
  VirtualDesktop& operator=(const VirtualDesktop&) = delete;
  const std::string& name() const { return name_; }  // for $DISPLAY
  /// Tells programs to draw that much larger, as desktops do for displays of small pixels.
  void scale(double factor) const;

 private:
  int server_ = -1;
  std::string name_;
};

/// Starts `xrds view` with these arguments and a script, under the validation layers, with a configuration folder of
/// its own; files in the script and the arguments may be named relative to `folder`.
Ended runViewer(const VirtualDesktop& desktop, const TemporaryFolder& folder, const std::string& script,
                std::vector<std::string> arguments = {}, const std::map<std::string, std::string>& environment = {});

/// The 8-bit RGB values of a PNG file, 0 to 255.
Image readPng(const std::filesystem::path& file);

/// Fails the test unless nearly all values of the PNG are within `tolerance` of the stored one of the same name in
/// tests/viewer/expected. With $XRDS_UPDATE_EXPECTED set it is stored instead.
void expectLikeStored(const std::filesystem::path& file, double tolerance = 3);

/// Mean absolute difference of two images of one size.
double meanDifference(const Image& a, const Image& b);

/// The part of an image from (x, y) on.
Image cropped(const Image& image, int x, int y, int width, int height);

}  // namespace xrds::test
