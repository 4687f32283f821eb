#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>

#include "app/exit_code.h"
#include "app/program_folder.h"
#include "cli/commands.h"
#include "xrds/path_text.h"

#ifdef _WIN32
#include <process.h>
#else
#include <unistd.h>
#endif

namespace xrds {
namespace {

namespace fs = std::filesystem;

#ifdef _WIN32
constexpr char kProgram[] = "xrds-view.exe";
#else
constexpr char kProgram[] = "xrds-view";
#endif

// The viewer stands beside this program where both are installed, in a folder of its own where they are built.
fs::path viewerProgram() {
  std::error_code unreadable;
  for (const char* place : {".", "../viewer"})
    if (fs::path program = programFolder() / pathOf(place) / kProgram; fs::exists(program, unreadable)) return program;
#ifdef _WIN32
  throw Failure{ExitCode::usage, "The viewer is not built for Windows yet."};
#else
  throw Failure{ExitCode::usage,
                "This xrds has no viewer, as those of Python's wheels: take one of the packages for Linux, or build it "
                "where GLFW and Dear ImGui are installed (Debian: libglfw3-dev, libimgui-dev)."};
#endif
}

[[noreturn]] void become(const fs::path& program, const std::vector<std::string>& arguments) {
  const std::string name = program.string();
  std::vector<const char*> words{name.c_str()};
  for (const std::string& argument : arguments) words.push_back(argument.c_str());
  words.push_back(nullptr);
#ifdef _WIN32
  std::exit(static_cast<int>(_spawnv(_P_WAIT, words[0], words.data())));
#else
  execv(words[0], const_cast<char* const*>(words.data()));
  throw Failure{ExitCode::bug, "The viewer '" + name + "' does not start."};
#endif
}

}  // namespace

// A program of its own, so that this one needs no desktop's libraries.
void addView(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("view", "Show renders as they are upscaled, in a window");
  verb->prefix_command();
  verb->set_help_flag();  // the viewer has its own
  verb->callback([verb] { become(viewerProgram(), verb->remaining()); });
}

}  // namespace xrds
