#include "engine/kernel_family.h"

#include "engine/environment.h"
#include "xrds/error.h"

namespace xrds {

KernelFamily suitableFamily(const DeviceDescription& device) {
  if (device.kind == DeviceKind::cpu) return KernelFamily::lane;
  return device.matrixUnits == MatrixUnits::none ? KernelFamily::tile : KernelFamily::matrix;
}

KernelFamily chosenFamily(const DeviceDescription& device, const std::string& asked) {
  const std::string wanted = asked.empty() ? wantedKernelFamily() : asked;
  if (wanted.empty()) return suitableFamily(device);
  const KernelFamily family = kernelFamilyOf(wanted);
  if (family == KernelFamily::lane && device.kind != DeviceKind::cpu)
    throw Error("the kernel family 'lane' is for CPU devices, and " + device.name + " is none; choose plain or tile");
  if (usesMatrixUnits(family) && device.matrixUnits == MatrixUnits::none)
    throw Error("the kernel family '" + wanted + "' needs matrix units that multiply 16-bit floats, and " +
                device.name + " offers none to Vulkan; choose plain or tile");
  return family;
}

}  // namespace xrds
