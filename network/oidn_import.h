#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "network/network_model.h"

namespace xrds {

/// A network of Open Image Denoise as a model file of ours, by the name that it has there ("rt_hdr_alb_nrm").
struct ImportedNetwork {
  std::string name;
  TensorFile file;
};

/// The networks of the RT filter in a library of Open Image Denoise (ELF, 64 bits), known by the library's symbols; or
/// that of a single archive NAME.tza. Each is checked to be a complete model. Throws Error if the file is none of these
/// or is damaged: nothing in it is trusted.
std::vector<ImportedNetwork> importNetworks(const std::filesystem::path& path);

/// The same of a library held in memory.
std::vector<ImportedNetwork> networksOfLibrary(std::span<const std::byte> bytes, const std::string& name);

/// An archive as the model file of that name; `version` of the library, empty if not known. Throws Error.
ImportedNetwork networkOfArchive(std::span<const std::byte> bytes, const std::string& archive,
                                 const std::string& version);

}  // namespace xrds
