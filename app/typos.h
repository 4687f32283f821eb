#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace xrds {

/// What is wrong with a command line that could not be parsed, in one sentence: an unknown command or option with the
/// one that was probably meant, else what the parser says.
std::string usageSentence(const CLI::App& app, const CLI::ParseError& error);

/// Whether the command line names a command that does not exist, whose help nobody can have asked for.
bool namesUnknownCommand(const CLI::App& app);

}  // namespace xrds
