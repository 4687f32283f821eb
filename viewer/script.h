#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "viewer/script_verbs.h"

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
  /// What verbs do, by their words; each is given the line's arguments.
  using Actions = std::map<std::string, std::function<void(const std::vector<std::string>&)>>;
  /// Each verb but "wait" and "sleep" has an action. Throws Error if a line has an unknown verb or the wrong number of
  /// arguments.
  Script(std::vector<ScriptLine> lines, const std::vector<ScriptVerb>& verbs, Actions actions);

  bool finished() const { return lines_.empty(); }
  /// Seconds until a step can be taken, if all is ready by then or is now (`ready`); nothing: only when it is.
  std::optional<double> patience(bool ready) const;
  /// Takes the next step if `ready`; a verb with a leading '!' does not need it. Throws Error, with the line's number,
  /// what the verb throws.
  void step(bool ready);

 private:
  std::deque<ScriptLine> lines_;
  Actions actions_;
  std::chrono::steady_clock::time_point until_{};
};

}  // namespace xrds
