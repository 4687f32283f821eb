#pragma once

#include <csignal>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace xrds::test {

/// How a started program ended and what it said. The exit code is 1000 plus the signal's number if a signal ended it.
struct Ended {
  int exitCode = -1;
  std::string output, error;
};

inline bool contains(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

struct StartOptions {
  std::map<std::string, std::string> environment{};
  std::filesystem::path folder{};  // to start in; empty: here
  long largestFileBytes = -1;      // writing more fails, as on a full disk; -1: no limit
  bool fullOutput = false;         // standard output is /dev/full
};

/// Starts the built xrds and waits for its end.
Ended runXrds(const std::vector<std::string>& arguments, const StartOptions& options = {});

/// Starts xrds, sends it the signal as soon as `due` says so, and waits for the end; `due` is asked over and over.
Ended killXrds(const std::vector<std::string>& arguments, const std::function<bool()>& due,
               const StartOptions& options = {}, int signal = SIGKILL);

/// Starts xrds on a terminal of its own, types `keys` once the output contains `awaited`, and waits for the end.
/// `output` is all that appeared on the terminal.
Ended runOnTerminal(const std::vector<std::string>& arguments, const std::string& awaited, const std::string& keys,
                    const StartOptions& options = {});

}  // namespace xrds::test
