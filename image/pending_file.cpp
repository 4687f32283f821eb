#include "image/pending_file.h"

#include <chrono>
#include <cstdint>
#include <random>
#include <string>
#include <system_error>
#include <vector>

#include "xrds/error.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

const std::string kPrefix = ".xrds-", kSuffix = ".part";

fs::path temporaryBeside(const fs::path& path) {
  std::random_device random;
  const uint64_t number = (uint64_t{random()} << 32U) | random();
  return path.parent_path() / (kPrefix + std::to_string(number) + kSuffix);
}

// Where a chain of symbolic links ends, whether or not there is a file.
fs::path behindLinks(const fs::path& path) {
  constexpr int kMostLinks = 40;  // as Linux has it
  fs::path place = path;
  std::error_code failure;
  for (int link = 0; link < kMostLinks; ++link) {
    if (!fs::is_symlink(place, failure)) {
      return place;
    }
    place = place.parent_path() / fs::read_symlink(place, failure);  // an absolute target replaces the folder
  }
  throw Error("Cannot write '" + path.string() + "': its symbolic links go in circles; choose another name.");
}

// Windows tells of names that no file can have that they are free.
bool mayBeName([[maybe_unused]] const fs::path& name) {
#ifdef _WIN32
  constexpr size_t kLongest = 255;
  return name.native().size() <= kLongest && name.native().find_first_of(L"<>:\"|?*") == std::wstring::npos;
#else
  return true;
#endif
}

}  // namespace

PendingFile::PendingFile(const fs::path& path) {
  std::error_code failure;
  path_ = behindLinks(path);
  const fs::path folder = path_.has_parent_path() ? path_.parent_path() : fs::path(".");
  if (path_.filename().empty() || !fs::is_directory(folder, failure)) {
    throw Error("Cannot write '" + path.string() + "': expected an existing folder, found none at '" + folder.string() +
                "'; create it or choose another place.");
  }
  if (!mayBeName(path_.filename())) {
    throw Error("Cannot write '" + path.string() + "': no file can have this name; choose another one.");
  }
  const fs::file_status status = fs::status(path_, failure);
  if (status.type() == fs::file_type::none) {
    throw Error("Cannot write '" + path.string() + "': " + failure.message() + "; choose another name.");
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw Error("Cannot write '" + path.string() +
                "': expected a free name or a regular file, found something else; choose another name.");
  }
  temporaryPath_ = temporaryBeside(path_);
}

PendingFile::~PendingFile() {
  if (!committed_) {
    std::error_code ignored;
    fs::remove(temporaryPath_, ignored);
  }
}

void PendingFile::commit() {
  std::error_code failure;
  if (const fs::file_status replaced = fs::status(path_, failure); fs::exists(replaced)) {
    fs::permissions(temporaryPath_, replaced.permissions() & fs::perms::all, failure);
  }
  fs::rename(temporaryPath_, path_, failure);
  if (failure) {
    throw Error("Cannot write '" + path_.string() + "': renaming the finished file failed (" + failure.message() +
                "); check the permissions of the folder.");
  }
  committed_ = true;
}

void removeAbandonedFiles(const fs::path& folder) {
  std::error_code failure;
  const auto now = fs::file_time_type::clock::now();
  std::vector<fs::path> abandoned;
  for (fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, failure), end; !failure && entry != end;
       entry.increment(failure)) {
    const std::string name = entry->path().filename().string();
    std::error_code ignored;
    if (name.starts_with(kPrefix) && name.ends_with(kSuffix) &&
        now - entry->last_write_time(ignored) > std::chrono::hours(1) && !ignored)
      abandoned.push_back(entry->path());
  }
  for (const fs::path& file : abandoned) fs::remove(file, failure);
}

}  // namespace xrds
