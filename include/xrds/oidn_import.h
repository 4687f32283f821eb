#pragma once

#include <filesystem>
#include <vector>

#include "xrds/call.h"

namespace xrds {

/// Reads the networks of Open Image Denoise's RT filter out of the user's own library (libOpenImageDenoise_core.so of a
/// package of the system or of pip install pyoidn) or of one file NAME.tza, and writes each as a model file
/// FOLDER/NAME.safetensors, with licence and version in the metadata; the folder is made if it is not there. Returns
/// the files. A model of them is one of scale 1: it takes the noise out of a colour, with the help of albedo and
/// normal, or out of an albedo or a normal, which then is its colour; an Upscaler runs it. Throws Error if the file is
/// none of these or is damaged, or if a model file cannot be written.
inline std::vector<std::filesystem::path> importOidn(const std::filesystem::path& library,
                                                     const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  const auto add = [&](const char* file) { files.push_back(pathOf(file)); };
  call::Heard heard(add);
  heard.finish(xrdsImportOidn(call::text(library).c_str(), call::text(folder).c_str(),
                              decltype(heard)::template listen<const char*>, heard.user()));
  return files;
}

/// Where `xrds import` puts them and `xrds denoise` looks for them: $XRDS_DENOISERS; $XDG_DATA_HOME/xrds/denoisers,
/// else ~/.local/share/xrds/denoisers; %LOCALAPPDATA%\xrds\denoisers on Windows. Empty if the environment names none.
inline std::filesystem::path denoiserFolder() { return pathOf(xrdsGetDenoiserFolder()); }

}  // namespace xrds
