#include "api/oidn_import.h"

#include "api/c/handles.h"
#include "api/c/result.h"

using namespace xrds::c;

XrdsResult xrdsImportOidn(const char* library, const char* folder, XrdsMessage hear, void* user) {
  return guarded([&] {
    const auto from = pathOf(&required(library, "library")), to = pathOf(&required(folder, "folder"));
    for (const auto& file : xrds::writeOidnModels(from, to))
      if (hear) hear(user, xrds::call::text(file).c_str());
    return XRDS_OK;
  });
}

const char* xrdsGetDenoiserFolder() {
  thread_local std::string text;
  text.clear();
  guarded([&] {
    text = xrds::call::text(xrds::folderOfDenoisers());
    return XRDS_OK;
  });
  return text.c_str();  // NOLINT(clang-analyzer-cplusplus.InnerPointer): it lives as long as the thread
}
