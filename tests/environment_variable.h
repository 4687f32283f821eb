#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace xrds::test {

/// A variable of the environment as a user would set it, for as long as this lives.
class EnvironmentVariable {
 public:
  EnvironmentVariable(const char* name, const std::filesystem::path& value) : name_(name) {
#ifdef _WIN32
    if (const wchar_t* present = _wgetenv(std::filesystem::path(name).c_str())) before_ = present;
#else
    if (const char* present = std::getenv(name)) before_ = present;
#endif
    set(&value);
  }
  ~EnvironmentVariable() { set(before_ ? &*before_ : nullptr); }
  EnvironmentVariable(const EnvironmentVariable&) = delete;
  EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;

 private:
  void set(const std::filesystem::path* value) const {
#ifdef _WIN32
    _wputenv_s(std::filesystem::path(name_).c_str(), value ? value->c_str() : L"");
#else
    value ? setenv(name_, value->c_str(), 1) : unsetenv(name_);
#endif
  }

  const char* name_;
  std::optional<std::filesystem::path> before_;
};

}  // namespace xrds::test
