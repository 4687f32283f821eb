#include "app/typos.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

#include "app/listed.h"
#include "app/nearest.h"

namespace xrds {
namespace {

/// An option that the user knows from another command, where it means something else.
struct Elsewhere {
  const char *option, *here, *meaning;
};
constexpr Elsewhere kElsewhere[] = {
    {"--colour", "--samples", "the colour's samples a pixel are --samples"},
    {"--color", "--samples", "the colour's samples a pixel are --samples"},
};

std::vector<std::string> commandsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

std::vector<std::string> optionsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string unknownOption(const CLI::App& verb, const std::string& command, const std::string& option) {
  const std::vector<std::string> names = optionsOf(verb);
  const std::string start = command + " has no option '" + option + "'; ";
  for (const Elsewhere& other : kElsewhere)
    if (option == other.option && std::find(names.begin(), names.end(), other.here) != names.end())
      return start + other.meaning;
  const std::string meant = nearest(option, names);
  return start + (meant.empty() ? "" : "the nearest is '" + meant + "'; ") + "see " + command + " --help";
}

std::string unknownCommand(const CLI::App& app, const std::string& command, const std::string& typed) {
  const std::vector<std::string> names = commandsOf(app);
  const std::string meant = nearest(typed, names);
  const std::string known = (names.size() > 1 ? "there are " : "there is ") + listed(names);
  return "There is no command '" + command + " " + typed + "'; " +
         (meant.empty() ? known : "the nearest is '" + meant + "'") + "; see " + command + " --help";
}

bool hasUnknownCommand(const CLI::App& verb) {
  const std::vector<std::string> unknown = verb.remaining();
  return !unknown.empty() && !unknown.front().starts_with("-") && !commandsOf(verb).empty();
}

/// The command that was found last, or the one before an unknown command, and as it was typed.
struct Found {
  const CLI::App* verb;
  std::string command;
};
Found foundIn(const CLI::App& app) {
  Found found{&app, app.get_name()};
  while (!found.verb->get_subcommands().empty() && !hasUnknownCommand(*found.verb)) {
    found.verb = found.verb->get_subcommands().front();
    found.command += " " + found.verb->get_name();
  }
  return found;
}

}  // namespace

bool namesUnknownCommand(const CLI::App& app) { return hasUnknownCommand(*foundIn(app).verb); }

std::string usageSentence(const CLI::App& app, const CLI::ParseError& error) {
  const auto [verb, command] = foundIn(app);
  const std::vector<std::string> unknown = verb->remaining();
  if (hasUnknownCommand(*verb)) return unknownCommand(*verb, command, unknown.front());
  for (const std::string& word : unknown)
    if (word.starts_with("-")) return unknownOption(*verb, command, word.substr(0, word.find('=')));
  if (!unknown.empty())
    return command + " takes no further argument '" + unknown.front() + "'; see " + command + " --help";
  return std::string(error.what()) + "; see " + command + " --help";
}

}  // namespace xrds
