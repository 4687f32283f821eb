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
  const std::string without = device.kind == DeviceKind::cpu ? "lane, plain or tile" : "plain or tile";
  if (family == KernelFamily::lane && device.kind != DeviceKind::cpu)
    throw Error("The kernel family 'lane' is for CPU devices, and " + device.name + " is none; choose plain or tile.");
  if (usesMatrixUnits(family) && device.matrixUnits == MatrixUnits::none)
    throw Error("The kernel family '" + wanted + "' needs matrix units that multiply 16-bit floats, and " +
                device.name + " offers none to Vulkan, or has too few registers for them; choose " + without + ".");
  if (family == KernelFamily::fused && !device.matrixSize.halfSums)
    throw Error("The kernel family 'fused' needs matrix units that add up in 16 bits, too, and those of " +
                device.name + " do not; choose matrix, " + without + ".");
  return family;
}

KernelFamily likelyFamily(const DeviceDescription& device) {
  if (const std::string wanted = wantedKernelFamily(); !wanted.empty()) kernelFamilyOf(wanted);
  try {
    return chosenFamily(device, "");
  } catch (const Error&) {
    return suitableFamily(device);
  }
}

DeviceTraits usualTraits(KernelFamily family) {
  const bool isCpu = family == KernelFamily::lane;
  return {.family = family,
          .matrixUnits = usesMatrixUnits(family) ? MatrixUnits::khr : MatrixUnits::none,
          .subgroupSize = isCpu ? 8u : 32u,
          .memoryBytes = family == KernelFamily::plain || isCpu ? 0 : uint64_t{8} << 30,
          .maxSharedBytes = isCpu ? 32768u : 49152u,
          .shaderInt64 = isCpu};
}

}  // namespace xrds
