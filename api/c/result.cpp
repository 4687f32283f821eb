#include "api/c/result.h"

namespace xrds::c {

std::string& message() {
  thread_local std::string text;
  return text;
}

XrdsResult failed(XrdsResult result, const char* text) noexcept {
  try {
    message() = text;
  } catch (...) {  // no memory for the sentence: the result has to do
  }
  return result;
}

}  // namespace xrds::c

void xrdsGetVersion(uint32_t* major, uint32_t* minor, uint32_t* patch) {
  if (major) *major = XRDS_VERSION_MAJOR;
  if (minor) *minor = XRDS_VERSION_MINOR;
  if (patch) *patch = XRDS_VERSION_PATCH;
}

const char* xrdsGetMessage() { return xrds::c::message().c_str(); }
