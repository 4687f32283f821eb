#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "app/failing_with.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/output_file.h"
#include "xrds/oidn_import.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

struct ImportOptions {
  std::string path, folder;
  bool quiet = false;
};

// Asked before the library is read. The folder is made when that is known to hold networks.
void requireFolder(const std::filesystem::path& folder) {
  std::error_code unreadable;
  std::filesystem::path there = std::filesystem::absolute(folder);
  while (!std::filesystem::exists(there, unreadable) && there.has_relative_path()) there = there.parent_path();
  try {
    requireWritable((there / ".xrds").string());
  } catch (const Failure&) {
    throw Failure{ExitCode::output, "The models cannot be written to '" + folder.string() + "': '" + there.string() +
                                        "' is no folder that takes new files; choose another with --output FOLDER."};
  }
}

void run(const ImportOptions& options) {
  const std::filesystem::path folder = options.folder.empty() ? denoiserFolder() : pathOf(options.folder);
  if (folder.empty())
    throw Failure{ExitCode::usage, "The environment names no home: say where to put the models with --output FOLDER."};
  requireFolder(folder);
  const auto files = failingWith(ExitCode::model, [&] { return importOidn(pathOf(options.path), folder); });
  if (options.quiet) return;
  for (const auto& file : files) std::printf("%s\n", file.string().c_str());
  std::printf("%zu networks of Open Image Denoise, licence Apache-2.0, for xrds denoise\n", files.size());
}

}  // namespace

void addImport(CLI::App& app) {
  const auto options = std::make_shared<ImportOptions>();
  CLI::App* group = app.add_subcommand("import", "Make model files of networks that other programs bring");
  group->require_subcommand(1);
  group->footer("Examples:\n  xrds import oidn libOpenImageDenoise_core.so.2.5.1");
  CLI::App* verb =
      group->add_subcommand("oidn", "The networks of your own copy of Open Image Denoise, for xrds denoise");
  verb->add_option("PATH", options->path,
                   "libOpenImageDenoise_core.so of your system's package or of pip install pyoidn, or a .tza file")
      ->required();
  verb->add_option("-o,--output", options->folder,
                   "Folder to write the model files to (default: $XRDS_DENOISERS, else xrds/denoisers in "
                   "$XDG_DATA_HOME or\n~/.local/share)")
      ->type_name("FOLDER");
  addQuiet(*verb, options->quiet);
  verb->footer(
      "Examples:\n  xrds import oidn .venv/lib/python3.11/site-packages/pyoidn/oidn/lib/"
      "libOpenImageDenoise_core.so.2.5.1");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
