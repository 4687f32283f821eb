#include "engine/dispatch.h"

namespace xrds {

std::string programName(const char* op, KernelFamily family, DataType stored) {
  static constexpr const char* kFamilies[] = {"plain", "lane", "tile", "matrix"};
  return std::string(op) + "_" + kFamilies[static_cast<int>(family)] + (stored == DataType::f32 ? "_f32" : "_f16");
}

}  // namespace xrds
