// Hostile model files: the safetensors container, the network's symbols in it, and the check that it is complete. An
// Error is a fair answer; any other exception, and whatever a sanitizer finds, is not.
#include <cstdint>
#include <span>

#include "network/network_model.h"
#include "xrds/error.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t byteSize) {
  try {
    const auto file = std::as_bytes(std::span(bytes, byteSize));
    const auto model = xrds::NetworkModel::fromTensors(xrds::parseTensors(file, "file"), "file");
    xrds::buildGraph(model.config(), {3, 5}, model.lookup(), {xrds::Precision::fp16});
  } catch (const xrds::Error&) {
  }
  return 0;
}
