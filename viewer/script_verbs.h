#pragma once

#include <string>
#include <vector>

namespace xrds {

/// A step that scripts can take: its word, the names of what is given to it ("..." at the end: one or more), and what
/// it does. Scripts are read and `xrds view --help` is written by this.
struct ScriptVerb {
  const char* word;
  const char* arguments;
  const char* text;
  bool atOnce = false;  // it waits for nothing

  /// How many arguments it takes; -1: one or more.
  int argumentCount() const;
};

/// Every step, in the order of the help.
const std::vector<ScriptVerb>& scriptVerbs();

/// All steps, for the help.
std::string scriptHelp();

}  // namespace xrds
