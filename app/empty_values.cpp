#include "app/empty_values.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "app/exit_code.h"

namespace xrds {

void refuseEmptyValues(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    const auto& values = option->results();
    if (std::find(values.begin(), values.end(), "") != values.end())
      throw Failure{ExitCode::usage, option->get_name() + " is empty: give it a value, or leave it out."};
  }
  for (const CLI::App* command : app.get_subcommands()) refuseEmptyValues(*command);
}

}  // namespace xrds
