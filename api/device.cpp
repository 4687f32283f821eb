#include "api/engine_access.h"
#include "checks/matrix_proof.h"
#include "engine/environment.h"
#include "engine/kernel_family.h"
#include "shaders/programs.h"

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

Device EngineAccess::open(Gpu gpu) { return Device(std::make_unique<Device::State>(Device::State{std::move(gpu)})); }

Device::Device(const Options& options)
    : state_(new State{Gpu({.select = options.select,
                            .validation = options.validation,
                            .onMessage = options.onMessage,
                            .cacheFolder = options.cacheFolder,
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
