#pragma once

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>

namespace xrds {

/// Help texts of commands, whose descriptions are broken into lines that a wide terminal holds.
class HelpFormat : public CLI::Formatter {
 public:
  std::string make_option_desc(const CLI::Option* option) const override {
    constexpr size_t kWidth = 100;  // behind the names
    std::istringstream lines(CLI::Formatter::make_option_desc(option));
    std::string broken;
    for (std::string line; std::getline(lines, line);) {
      for (size_t space; line.size() > kWidth && (space = line.rfind(' ', kWidth)) != std::string::npos;
           line.erase(0, space + 1))
        broken += line.substr(0, space) + "\n";
      broken += line + "\n";
    }
    if (!broken.empty()) broken.pop_back();
    return broken;
  }
};

}  // namespace xrds
