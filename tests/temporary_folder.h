#pragma once

#include <filesystem>
#include <iterator>
#include <random>
#include <string>
#include <system_error>

namespace xrds::test {

/// A folder of its own for one test, removed with all that is in it at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() { std::filesystem::create_directories(path_); }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  size_t fileCount() const {
    const std::filesystem::directory_iterator files(path_);
    return static_cast<size_t>(std::distance(begin(files), end(files)));
  }

 private:
  const std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("xrds_test_" + std::to_string(std::random_device{}()));
};

}  // namespace xrds::test
