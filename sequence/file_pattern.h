#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace xrds {

/// Whether a file's name ends in `extension` (".exr"), in upper or lower case.
bool hasExtension(const std::filesystem::path& file, std::string_view extension);

/// The names of a sequence's files: a path whose file name has the frame's number in it.
class FilePattern {
 public:
  /// "beauty.####.exr" (as many digits, and more where the number has them), "beauty.%04d.exr", "beauty.%d.exr", or a
  /// folder that holds one numbered series of EXR files and may hold others beside it. Anything else is one file, the
  /// same for all frames. Throws Error if there are several fields, or no series or several in the folder.
  explicit FilePattern(const std::string& text);

  /// Whether a path names many files: isMany() of its FilePattern, without a look into folders.
  static bool mayBeMany(const std::string& text);

  /// Whether the names differ from frame to frame.
  bool isMany() const { return digits_ > 0; }

  /// The file of a frame, with the digits of printf's "%0*d".
  std::filesystem::path of(int frame) const;

  /// The frames whose files are there, in rising order. Throws Error if the folder cannot be read.
  std::vector<int> frames() const;

  /// The same names in another folder.
  FilePattern in(const std::filesystem::path& folder) const;

  /// As it was given; a folder's with its series: "renders/beauty.####.exr".
  std::string text() const;

 private:
  FilePattern() = default;
  bool isPrintf() const { return field_.starts_with('%'); }  // the digits count the sign
  void findSeries(const std::filesystem::path& folder);

  std::filesystem::path folder_;
  std::string before_, field_, after_;  // of the file name; the field stands for the number
  int digits_ = 0;                      // at least; 0: no number
};

}  // namespace xrds
