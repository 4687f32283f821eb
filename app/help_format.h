#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>

namespace xrds {

/// Help texts of commands, whose descriptions are broken into lines that a wide terminal holds.
class HelpFormat : public CLI::Formatter {
 public:
  std::string make_option_desc(const CLI::Option* option) const override {
    constexpr size_t kWidth = 100;  // behind the names
    std::string text = CLI::Formatter::make_option_desc(option);
    std::replace(text.begin(), text.end(), '\n', ' ');  // breaks of the source
    for (size_t line = 0, space; text.size() - line > kWidth; line = space + 1) {
      space = text.rfind(' ', line + kWidth);
      if (space == std::string::npos || space <= line) break;
      text[space] = '\n';
    }
    return text;
  }
};

}  // namespace xrds
