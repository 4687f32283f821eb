#pragma once

namespace CLI {
class App;
}

namespace xrds {

/// Throws Failure with ExitCode::usage if an option or argument of the command that was given, or of its subcommands,
/// has an empty value: a variable of a script that is not set, which must not count as no option.
void refuseEmptyValues(const CLI::App& app);

}  // namespace xrds
