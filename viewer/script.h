#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace xrds {

/// One line of a script: a word and what it is given.
struct ScriptLine {
  int number = 0;
  std::string verb;
  std::vector<std::string> arguments;
};

/// Splits a script into its lines; '#' begins a comment. Throws Error if the file cannot be read.
std::vector<ScriptLine> readScript(const std::filesystem::path& file);

/// Plays a script while a program runs: a step at a time, as soon as the steps before it have taken effect.
class Script {
 public:
  /// What a verb does; each is given the line's arguments, of which `count` are needed (-1: one or more).
  struct Verb {
    int count;
    std::function<void(const std::vector<std::string>&)> action;
  };
  /// Throws Error if a line has an unknown verb or the wrong number of arguments.
  Script(std::vector<ScriptLine> lines, std::map<std::string, Verb> verbs);

  bool finished() const { return lines_.empty(); }
  /// Seconds until a step can be taken, if all is ready by then or is now (`ready`); nothing: only when it is.
  std::optional<double> patience(bool ready) const;
  /// Takes the next step if `ready`. Besides the given verbs there are "wait", which does nothing but need readiness,
  /// and "sleep SECONDS"; a verb with a leading '!' does not need it. Throws Error, with the line's number, what the
  /// verb throws.
  void step(bool ready);

 private:
  std::deque<ScriptLine> lines_;
  std::map<std::string, Verb> verbs_;
  std::chrono::steady_clock::time_point until_{};
};

}  // namespace xrds
