#include "app/kernel_family.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "app/exit_code.h"
#include "xrds/device.h"

namespace xrds {

void checkKernelFamilyVariable() {
  const char* text = std::getenv("XRDS_KERNEL_FAMILY");
  const std::string wanted = text ? text : "";
  const auto families = Device::kernelFamilies();
  if (wanted.empty() || std::find(families.begin(), families.end(), wanted) != families.end()) return;
  std::string list;
  for (const std::string& family : families) list += (list.empty() ? "" : ", ") + family;
  throw Failure{ExitCode::usage, "XRDS_KERNEL_FAMILY is '" + wanted + "', expected one of " + list + "; or unset it."};
}

}  // namespace xrds
