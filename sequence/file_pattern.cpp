#include "sequence/file_pattern.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <regex>
#include <system_error>
#include <tuple>

#include "sequence/frame_range.h"
#include "xrds/error.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

const std::regex& field() {
  static const std::regex kPattern(R"(#+|%(0(\d+))?d)");
  return kPattern;
}

// The digits of a frame: of negative ones behind the sign, as Blender has them, or with it, as printf does.
std::string digitsOf(long long frame, int digits, bool withSign) {
  char written[32];
  const long long number = frame < 0 && !withSign ? -frame : frame;
  std::snprintf(written, sizeof written, "%s%0*lld", number == frame ? "" : "-", std::clamp(digits, 1, 10), number);
  return written;
}

// The number that the digits between are, if they are what of() writes for it with at least so many digits.
std::optional<int> numberOf(const std::string& text, int digits, bool withSign) {
  if (text.empty() || text.size() > 11) return {};
  const long long number = std::strtoll(text.c_str(), nullptr, 10);
  if (digitsOf(number, digits, withSign) != text || std::abs(number) > kLargestFrame) return {};
  return static_cast<int>(number);
}

// The number of digits that printf's field asks for; 0 where it is far too large.
int digitsIn(const std::string& field) {
  int digits = 0;
  std::from_chars(field.data(), field.data() + field.size(), digits);
  return digits;
}

std::vector<fs::path> filesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failure;
  for (fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, failure), end; !failure && entry != end;
       entry.increment(failure))
    if (!entry->is_directory(failure)) files.push_back(entry->path().filename());
  if (failure) throw Error("Cannot read the folder '" + folder.string() + "': " + failure.message() + ".");
  return files;
}

}  // namespace

bool hasExtension(const fs::path& file, std::string_view extension) {
  std::string found = file.extension().string();
  std::transform(found.begin(), found.end(), found.begin(), [](unsigned char c) { return std::tolower(c); });
  return found == extension;
}

bool FilePattern::mayBeMany(const std::string& text) {
  std::error_code ignored;
  const fs::path path = pathOf(text);
  if (fs::is_directory(path, ignored)) return true;
  return !fs::exists(path, ignored) && std::regex_search(path.filename().string(), field());
}

FilePattern::FilePattern(const std::string& text) {
  std::error_code ignored;
  const fs::path path = pathOf(text);
  if (fs::is_directory(path, ignored)) {
    findSeries(path);
    return;
  }
  folder_ = path.parent_path();
  before_ = path.filename().string();
  std::smatch match;
  const std::string name = before_;
  if (fs::exists(path, ignored) || !std::regex_search(name, match, field())) return;
  before_ = match.prefix();
  after_ = match.suffix();
  field_ = match.str();
  digits_ = !isPrintf() ? static_cast<int>(match.length()) : match[2].matched ? digitsIn(match[2].str()) : 1;
  if (digits_ < 1 || digits_ > 10 || std::regex_search(after_, field()))
    throw Error("'" + text + "' is no name of frames: expected one field of at most 10 digits, #### or %04d.");
}

void FilePattern::findSeries(const fs::path& folder) {
  folder_ = folder;
  static const std::regex kLast(R"(^(.*?)(\d+)(\D*)$)");
  using Series = std::pair<std::string, std::string>;
  std::map<Series, std::vector<std::string>> found;
  for (const fs::path& file : filesIn(folder)) {
    const std::string name = file.filename().string();
    if (std::smatch match; hasExtension(file, ".exr") && std::regex_match(name, match, kLast)) {
      std::string before = match[1];
      if (before.ends_with(".-") || before.ends_with("_-")) before.pop_back();  // a sign
      found[{before, match[3]}].push_back(match[2]);
    }
  }
  if (found.size() != 1) {
    std::string names;
    for (const auto& [series, numbers] : found)
      names += (names.empty() ? ": " : ", ") + series.first + std::string(numbers.front().size(), '#') + series.second;
    throw Error("The folder '" + folder.string() + "' holds " + std::to_string(found.size()) +
                " numbered series of EXR files" + names + "; name one, such as beauty.####.exr.");
  }
  const auto& [series, numbers] = *found.begin();
  std::tie(before_, after_) = series;
  const auto shorter = [](const std::string& a, const std::string& b) { return a.size() < b.size(); };
  digits_ = static_cast<int>(std::min_element(numbers.begin(), numbers.end(), shorter)->size());
  field_ = std::string(static_cast<size_t>(digits_), '#');
}

fs::path FilePattern::of(int frame) const {
  if (!isMany()) return folder_ / pathOf(before_);
  return folder_ / pathOf(before_ + digitsOf(frame, digits_, isPrintf()) + after_);
}

std::vector<int> FilePattern::frames() const {
  std::vector<int> found;
  if (!isMany()) return found;
  for (const fs::path& file : filesIn(folder_)) {
    const std::string name = file.string();
    if (name.size() <= before_.size() + after_.size() || !name.starts_with(before_) || !name.ends_with(after_))
      continue;
    const std::string between = name.substr(before_.size(), name.size() - before_.size() - after_.size());
    if (const auto number = numberOf(between, digits_, isPrintf())) found.push_back(*number);
  }
  std::sort(found.begin(), found.end());
  return found;
}

FilePattern FilePattern::in(const fs::path& folder) const {
  FilePattern other = *this;
  other.folder_ = folder;
  return other;
}

std::string FilePattern::text() const { return (folder_ / pathOf(before_ + field_ + after_)).string(); }

}  // namespace xrds
