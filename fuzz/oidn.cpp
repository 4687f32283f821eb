// Hostile libraries and archives of Open Image Denoise: the ELF container, the TZA archive in it, and the check that it
// is a complete model. An Error is a fair answer; any other exception, and whatever a sanitizer finds, is not.
#include <cstdint>
#include <span>

#include "network/oidn_import.h"
#include "network/tza.h"
#include "xrds/error.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t byteSize) {
  const auto file = std::as_bytes(std::span(bytes, byteSize));
  try {
    if (xrds::isTza(file))
      xrds::networkOfArchive(file, "rt_hdr_small", "");
    else
      xrds::networksOfLibrary(file, "file");
  } catch (const xrds::Error&) {
  }
  return 0;
}
