#pragma once

#include <filesystem>

namespace xrds {

/// Walks the headers of an OpenEXR file without keeping anything of them. Throws Error when an attribute claims more
/// bytes than the file has or other than its type takes: OpenEXR would allocate up to 2 GiB before it looks.
void requireAttributesInFile(const std::filesystem::path& path);

}  // namespace xrds
