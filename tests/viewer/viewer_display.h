#pragma once

#include <gtest/gtest.h>

#include <array>
#include <regex>

#include "tests/viewer/virtual_desktop.h"

namespace xrds::test {

inline const std::string kSamples = XRDS_SAMPLE_FOLDER;
inline const std::string kColour = kSamples + "/outdoor_lr64.exr", kAuxiliary = kSamples + "/outdoor_aux16.exr",
                         kReference = kSamples + "/outdoor_gt.exr";  // 80 x 60 to 320 x 240

/// The arguments of a run on a display that the picture just fills, with a fast model.
inline std::vector<std::string> smallDisplay(std::vector<std::string> files) {
  files.insert(files.end(), {"--size", "400x340", "--model", "xrds-x4-nano"});
  return files;
}

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

inline size_t occurrences(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// The numbers that follow each word `name` and '=' in the text.
inline std::vector<double> valuesOf(const std::string& text, const std::string& name) {
  std::vector<double> values;
  const std::regex pattern("(?:^|\\s)" + name + "=([-+.0-9e]+)");
  for (std::sregex_iterator at(text.begin(), text.end(), pattern); at != std::sregex_iterator(); ++at)
    values.push_back(std::stod((*at)[1]));
  return values;
}

/// The red, green and blue of each pixel that was printed of a view.
inline std::vector<std::array<double, 3>> printedOf(const std::string& output, const std::string& view) {
  std::vector<std::array<double, 3>> found;
  const std::regex pattern(" " + view + "@[0-9,]+=([-+.0-9e]+),([-+.0-9e]+),([-+.0-9e]+)");
  for (std::sregex_iterator at(output.begin(), output.end(), pattern); at != std::sregex_iterator(); ++at)
    found.push_back({std::stod((*at)[1]), std::stod((*at)[2]), std::stod((*at)[3])});
  return found;
}

/// A display on a desktop of its own, driven by scripts.
struct ViewerDisplay : testing::Test {
  VirtualDesktop desktop;
  TemporaryFolder folder;

  /// A run that must end well, without a message.
  Ended run(const std::string& script, const std::vector<std::string>& arguments) {
    Ended ended = runViewer(desktop, folder, script, arguments);
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    EXPECT_EQ(ended.error, "") << script;
    return ended;
  }
  void copy(const std::string& from, const std::string& to) const { std::filesystem::copy_file(from, folder / to); }
};

}  // namespace xrds::test
