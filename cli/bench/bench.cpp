#include <CLI/CLI.hpp>

#include "cli/commands.h"

namespace xrds {

void addBench(CLI::App& app) {
  CLI::App* group = app.add_subcommand("bench", "Measure the engine and its models");
  group->require_subcommand(1);
  group->footer("Examples:\n  xrds bench network\n  xrds bench quality val\n  xrds bench stress --short");
  addBenchQuality(*group);
  addBenchNetwork(*group);
  addBenchTiles(*group);
  addBenchSkip(*group);
  addBenchStress(*group);
}

}  // namespace xrds
