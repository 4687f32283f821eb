#pragma once

#include <cstdlib>
#include <optional>
#include <string>

namespace xrds::test {

/// A variable of the environment as a user would set it, for as long as this lives.
class EnvironmentVariable {
 public:
  EnvironmentVariable(const char* name, const std::string& value) : name_(name) {
    if (const char* present = std::getenv(name)) before_ = present;
    set(&value);
  }
  ~EnvironmentVariable() { set(before_ ? &*before_ : nullptr); }
  EnvironmentVariable(const EnvironmentVariable&) = delete;
  EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;

 private:
  void set(const std::string* value) const {
#ifdef _WIN32
    _putenv_s(name_, value ? value->c_str() : "");
#else
    value ? setenv(name_, value->c_str(), 1) : unsetenv(name_);
#endif
  }

  const char* name_;
  std::optional<std::string> before_;
};

}  // namespace xrds::test
