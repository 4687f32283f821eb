#include "app/kernel_family.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "app/exit_code.h"
#include "app/listed.h"
#include "xrds/device.h"

namespace xrds {

void checkKernelFamilyVariable() {
  const char* text = std::getenv("XRDS_KERNEL_FAMILY");
  const std::string wanted = text ? text : "";
  const auto families = Device::kernelFamilies();
  if (wanted.empty() || std::find(families.begin(), families.end(), wanted) != families.end()) return;
  throw Failure{ExitCode::usage,
                "XRDS_KERNEL_FAMILY is '" + wanted + "', expected one of " + listed(families) + "; or unset it."};
}

}  // namespace xrds
