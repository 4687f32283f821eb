#include "api/device.h"

#include "checks/matrix_proof.h"
#include "engine/environment.h"
#include "engine/host_device.h"
#include "engine/kernel_family.h"
#include "shaders/programs.h"
#include "xrds/error.h"

namespace xrds {
namespace {

Device::Description describeDevice(const DeviceDescription& device, KernelFamily family) {
  static constexpr const char* kKinds[] = {"discrete", "integrated", "virtual", "cpu", "other"};
  return {device.name,       kKinds[static_cast<size_t>(device.kind)],
          device.uuid,       device.driver,
          device.apiVersion, device.memoryBytes,
          nameOf(family)};
}

Gpu proven(Gpu gpu, const Device::Options& options) {
  proveAskedKernels(gpu, options.kernelFamily.empty() ? wantedKernelFamily() : options.kernelFamily);
  return gpu;
}

}  // namespace

std::vector<Device::Description> describeDevices() {
  std::vector<Device::Description> descriptions;
  for (const DeviceDescription& device : listDevices())
    descriptions.push_back(describeDevice(device, likelyFamily(device)));
  return descriptions;
}

Device::Description descriptionOf(const Gpu& gpu) { return describeDevice(gpu.description(), gpu.traits().family); }

Gpu openGpu(const Device::Options& options) {
  return proven(Gpu({.select = options.select,
                     .validation = options.validation,
                     .onMessage = options.onMessage,
                     .cacheFolder = options.cacheFolder,
                     .kernelFamily = options.kernelFamily,
                     .onPreparation = options.onPreparation,
                     .programs = embeddedProgram}),
                options);
}

Gpu openGpu(const Device::Options& options, const HostDevice& host) {
  if (!options.select.empty())
    throw InvalidArgument("A device was given and one is to be selected: leave the option select NULL.");
  return proven(Gpu({.cacheFolder = options.cacheFolder,
                     .kernelFamily = options.kernelFamily,
                     .onPreparation = options.onPreparation,
                     .programs = embeddedProgram},
                    host),
                options);
}

}  // namespace xrds
