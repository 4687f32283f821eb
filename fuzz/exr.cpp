// Hostile EXR files: headers, layer search, pixels, and the way of their attributes into an output file. An Error is a
// fair answer; any other exception, and whatever a sanitizer finds, is not.
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "image/exr/read.h"
#include "image/exr/write.h"
#include "image/layers/aov.h"
#include "xrds/error.h"

namespace {

namespace fs = std::filesystem;
constexpr int64_t kPixelsRead = 1 << 14;  // larger layers are slow, not interesting
constexpr size_t kLayersRead = 6;

// Set TMPDIR to a folder in memory: a file is written for each input.
fs::path fileOfThisRun(const char* name) {
  return fs::temp_directory_path() / ("xrds_fuzz_" + std::to_string(getpid()) + name);
}

template <class Action>
void tolerateErrors(Action&& action) {
  try {
    action();
  } catch (const xrds::Error&) {
  }
}

void readLayers(const xrds::ExrFile& file) {
  size_t read = 0;
  for (size_t part = 0; part < file.parts.size(); ++part)
    for (const xrds::ExrLayer& layer : file.parts[part].layers) {
      const xrds::Box& box = file.parts[part].dataWindow;
      if (box.width() * box.height() > kPixelsRead || ++read > kLayersRead) return;
      xrds::ExrSelection selection{part, layer.name, {}};
      for (const xrds::ExrChannel& channel : layer.channels)
        if (selection.channelNames.size() < 4) selection.channelNames.push_back(channel.name);
      tolerateErrors([&] { static_cast<void>(readLayer(file, selection)); });
    }
}

// The attributes of the first part beside new pixels, written and read back.
void passAttributesOn(const xrds::ExrPart& part, const fs::path& path) {
  xrds::ExrOutput output = scaledOutput(part, 2);
  output.dataWindow = {0, 0, 1, 0};
  writeExr(path, xrds::Image(2, 1, 3), output);
  static_cast<void>(describe(xrds::readExrHeader(path)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t byteSize) {
  static const fs::path input = fileOfThisRun("_in.exr"), output = fileOfThisRun("_out.exr");
  std::ofstream(input, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(byteSize));
  tolerateErrors([&] {
    const xrds::ExrFile file = xrds::readExrHeader(input);
    static_cast<void>(describe(file));
    tolerateErrors([&] { static_cast<void>(findAovs(file, file)); });
    readLayers(file);
    if (!file.parts.empty()) tolerateErrors([&] { passAttributesOn(file.parts.front(), output); });
  });
  return 0;
}
