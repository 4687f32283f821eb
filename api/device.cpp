#include "api/state.h"
#include "checks/matrix_proof.h"
#include "engine/environment.h"
#include "engine/host_device.h"
#include "engine/kernel_family.h"
#include "shaders/programs.h"
#include "xrds/engine_access.h"

namespace xrds {
namespace {

Device::Description describeDevice(const DeviceDescription& device) {
  static constexpr const char* kKinds[] = {"discrete", "integrated", "virtual", "cpu", "other"};
  return {device.name,
          kKinds[static_cast<size_t>(device.kind)],
          device.uuid,
          device.driver,
          device.apiVersion,
          device.memoryBytes,
          nameOf(device.kernelFamily)};
}

}  // namespace

std::vector<Device::Description> Device::list() {
  std::vector<Description> descriptions;
  for (const DeviceDescription& device : listDevices()) {
    descriptions.push_back(describeDevice(device));
    descriptions.back().kernelFamily = nameOf(likelyFamily(device));
  }
  return descriptions;
}

std::vector<std::string> Device::kernelFamilies() {
  const auto names = kernelFamilyNames();
  return {names.begin(), names.end()};
}

Device::Device(std::unique_ptr<State> state) : state_(std::move(state)) {}

Device EngineAccess::shared(const HostDevice& host, const Device::Options& options) {
  DeviceOptions asked{.cacheFolder = options.cacheFolder,
                      .kernelFamily = options.kernelFamily,
                      .onPreparation = options.onPreparation,
                      .programs = embeddedProgram};
  Device device(std::make_unique<Device::State>(Device::State{Gpu(std::move(asked), host)}));
  proveAskedKernels(device.state_->gpu, options.kernelFamily.empty() ? wantedKernelFamily() : options.kernelFamily);
  return device;
}

Device::Device(const Options& options)
    : state_(new State{Gpu({.select = options.select,
                            .validation = options.validation,
                            .onMessage = options.onMessage,
                            .cacheFolder = options.cacheFolder,
                            .instanceExtensions = options.instanceExtensions,
                            .deviceExtensions = options.deviceExtensions,
                            .kernelFamily = options.kernelFamily,
                            .onPreparation = options.onPreparation,
                            .programs = embeddedProgram})}) {
  proveAskedKernels(state_->gpu, options.kernelFamily.empty() ? wantedKernelFamily() : options.kernelFamily);
}
Device::~Device() = default;
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;
std::vector<std::string> Device::notes() const { return state_->gpu.notes(); }
Device::Description Device::description() const {
  Description description = describeDevice(state_->gpu.description());
  description.kernelFamily = nameOf(state_->gpu.traits().family);
  return description;
}

}  // namespace xrds
