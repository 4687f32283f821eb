#include "image/exr/open.h"

#include <OpenEXR/ImfTestFile.h>

#include <cerrno>
#include <fstream>
#include <new>
#include <string>
#include <system_error>

#include "image/exr/header_scan.h"

namespace xrds {

std::unique_ptr<Imf::MultiPartInputFile> openExr(const std::filesystem::path& path) {
  const std::string quoted = "'" + path.string() + "'";
  std::error_code failure;
  const auto status = std::filesystem::status(path, failure);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw Error("Cannot read " + quoted + ": there is no such file; check the name.");
  }
  if (!std::filesystem::exists(status)) {
    throw Error("Cannot read " + quoted + ": " + failure.message() + ".");
  }
  if (std::filesystem::is_directory(status)) {
    throw Error("Cannot read " + quoted + ": expected a file, found a folder.");
  }
  if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, failure) == 0 && !failure) {
    throw Error("Cannot read " + quoted + ": expected an OpenEXR image, found an empty file; render it again.");
  }
  if (errno = 0; !std::ifstream(path)) {
    throw Error("Cannot read " + quoted + ": " + std::generic_category().message(errno) + ".");
  }
  if (!Imf::isOpenExrFile(path.string().c_str())) {
    throw Error("Cannot read " + quoted + ": expected an OpenEXR image, found another kind of file; check the name.");
  }
  requireAttributesInFile(path);
  return std::make_unique<Imf::MultiPartInputFile>(path.string().c_str());
}

Error unreadable(const std::filesystem::path& path, const std::exception& reason) {
  const std::string start = "Cannot read '" + path.string() + "': ";
  if (dynamic_cast<const std::bad_alloc*>(&reason) != nullptr) {
    return Error(start + "it asks for more memory than there is; check that the file is intact.");
  }
  return Error(start + "expected a complete OpenEXR image, found a damaged or unfinished one (" + reason.what() +
               "); render or copy it again.");
}

}  // namespace xrds
