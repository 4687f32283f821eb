#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <iostream>
#include <thread>

#include "app/empty_values.h"
#include "app/failing_with.h"
#include "app/help_format.h"
#include "app/kernel_family.h"
#include "app/typos.h"
#include "app/utf8_console.h"
#include "cli/commands.h"
#include "cli/progress.h"
#include "image/exr/file.h"

namespace {

constexpr const char* kFooter =
    "Exit codes: 0 done; 1 a bug of xrds; 2 wrong option; 3 an image cannot be read or does not fit; 4 the model "
    "cannot\n"
    "be read or does not fit; 5 no Vulkan device or display, it failed or lacks memory; 6 a result cannot be written; "
    "7 a check\n"
    "found a difference, or advise no plan; 8 frames of a sequence could not be made, the others were; 130 "
    "interrupted.\n"
    "Only finished files are ever written.\n\n"
    "Examples:\n"
    "  xrds upscale color_64spp.exr aux_16spp.exr -o out.exr\n"
    "  xrds compare out.exr reference.exr\n"
    "  xrds info xrds-x4-compact --size 1920x1080\n";

int fail(xrds::ExitCode code, const std::string& message) {
  const bool list = message.find('\n') != std::string::npos;
  const char* end = list || message.ends_with('.') || message.ends_with('?') ? "" : ".";
  std::fprintf(stderr, "xrds: %s%s\n", message.c_str(), end);
  return static_cast<int>(code);
}

// The exit code of what went well, if all that it printed was taken.
int ended() {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout) return static_cast<int>(xrds::ExitCode::ok);
  return fail(xrds::ExitCode::output, "Cannot write to standard output: is the disk full?");
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): only the handlers could throw, when building a message fails
int main(int argc, char** argv) {
  static const xrds::Utf8Console console;  // std::exit() leaves it, too
  CLI::App app(
      "Upscales Monte Carlo renders: low-resolution colour and full-resolution albedo and normals in, the\n"
      "full-resolution picture out, on any Vulkan device.",
      "xrds");
  app.allow_windows_style_options(false);  // there, too, /renders/a.exr is a file
  app.formatter(std::make_shared<xrds::HelpFormat>());
  app.set_version_flag("--version", "xrds " XRDS_VERSION);
  app.require_subcommand(1);
  app.footer(kFooter);
  app.parse_complete_callback([&app] {
    xrds::checkKernelFamilyVariable();
    xrds::refuseEmptyValues(app);
  });
  xrds::addUpscale(app);
  xrds::addAdvise(app);
  xrds::addCompare(app);
  xrds::addInfo(app);
  xrds::addDevices(app);
  xrds::addView(app);
  xrds::addDoctor(app);
  xrds::addTune(app);
  xrds::addDenoise(app);
  xrds::addImport(app);
  xrds::addBench(app);
  xrds::catchInterrupts();
  try {
    xrds::useExrThreads(static_cast<int>(std::thread::hardware_concurrency()));
    app.parse(argc, argv);
    return ended();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0 && !xrds::namesUnknownCommand(app)) {  // --help and --version
      app.exit(error);
      return ended();
    }
    return fail(xrds::ExitCode::usage, xrds::usageSentence(app, error));
  } catch (...) {
    const xrds::Failure failure = xrds::failureOf(std::current_exception());
    return fail(failure.code, failure.message);
  }
}
