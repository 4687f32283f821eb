#pragma once

#include <OpenEXR/ImfMultiPartInputFile.h>

#include <exception>
#include <filesystem>
#include <memory>

#include "xrds/error.h"

namespace xrds {

/// Opens a file with OpenEXR. Throws Error when it is absent, empty or no OpenEXR file, and whatever OpenEXR throws
/// when it is damaged; call it inside `withExrErrors`.
std::unique_ptr<Imf::MultiPartInputFile> openExr(const std::filesystem::path& path);

/// The Error for a file that OpenEXR refuses with the given reason.
Error unreadable(const std::filesystem::path& path, const std::exception& reason);

/// Runs `action`, turning every exception of OpenEXR into an Error that names the file.
template <typename Action>
auto withExrErrors(const std::filesystem::path& path, Action&& action) {
  try {
    return action();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& reason) {
    throw unreadable(path, reason);
  }
}

}  // namespace xrds
