#include "cli/output_file.h"

#include <fstream>

#include "app/failing_with.h"
#include "image/pending_file.h"
#include "sequence/file_pattern.h"
#include "xrds/path_text.h"

namespace xrds {

void requireExtension(const std::string& path, const std::string& extension, const char* option) {
  if (!hasExtension(pathOf(path), extension))
    throw Failure{ExitCode::usage,
                  std::string(option) + " takes a name that ends in " + extension + ", found '" + path + "'."};
}

void requireWritable(const std::string& path) {
  failingWith(ExitCode::output, [&] {
    const PendingFile probe(pathOf(path));
    if (!std::ofstream(probe.temporaryPath()))
      throw Error("Cannot write '" + path +
                  "': its folder takes no new files; check the permissions or choose another place.");
  });
}

void requireOutput(const std::string& path, const std::string& extension, const char* option) {
  if (path.empty()) return;
  requireExtension(path, extension, option);
  requireWritable(path);
}

void writeText(const std::string& path, const std::string& text) {
  PendingFile file(pathOf(path));
  std::ofstream stream(file.temporaryPath(), std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw Error("Cannot write '" + path + "': is the disk full?");
  file.commit();
}

}  // namespace xrds
