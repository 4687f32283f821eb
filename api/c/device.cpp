#include "api/c/handles.h"
#include "api/c/result.h"
#include "api/c/sized.h"
#include "api/c/text.h"
#include "engine/kernel_family.h"

using namespace xrds::c;

namespace {

void describe(const xrds::Device::Description& found, XrdsDeviceDescription& description) {
  XrdsDeviceDescription out{};
  setText(out.name, found.name);
  setText(out.kind, found.kind);
  setText(out.uuid, found.uuid);
  setText(out.driver, found.driver);
  setText(out.apiVersion, found.apiVersion);
  setText(out.kernelFamily, found.kernelFamily);
  out.memoryBytes = found.memoryBytes;
  give(out, description);
}

}  // namespace

namespace xrds::c {

Device::Options optionsOf(const XrdsDeviceOptions& given) {
  Device::Options options{.select = textOf(given.select),
                          .cacheFolder = pathOf(given.cacheFolder),
                          .kernelFamily = textOf(given.kernelFamily),
                          .validation = given.validation != 0};
  if (given.message)
    options.onMessage = [hear = given.message, user = given.messageUser](std::string_view text) {
      hear(user, std::string(text).c_str());
    };
  if (given.preparation)
    options.onPreparation = [hear = given.preparation, user = given.preparationUser](const Preparation& now) {
      return hear(user, now.phase == Preparation::Phase::machineCode, now.done, now.total) != 0;
    };
  return options;
}

}  // namespace xrds::c

XrdsDeviceOptions xrdsDeviceOptionsDefault() { return {.structSize = sizeof(XrdsDeviceOptions)}; }

XrdsResult xrdsCountDevices(uint32_t* count) {
  return guarded([&] {
    required(count, "count") = static_cast<uint32_t>(xrds::describeDevices().size());
    return XRDS_OK;
  });
}

XrdsResult xrdsDescribeDevice(uint32_t index, XrdsDeviceDescription* description) {
  return guarded([&] {
    checkedSize(required(description, "description"));
    const auto devices = xrds::describeDevices();
    if (index >= devices.size())
      throw xrds::InvalidArgument("There is no device " + std::to_string(index) + ": there are " +
                                  std::to_string(devices.size()) + ".");
    describe(devices[index], *description);
    return XRDS_OK;
  });
}

XrdsResult xrdsOpenDevice(const XrdsDeviceOptions* options, XrdsDevice** device) {
  return guarded([&] {
    XrdsDevice*& out = required(device, "device");
    const XrdsDeviceOptions usual = xrdsDeviceOptionsDefault(), given = options ? taken(*options, usual) : usual;
    out = Devices::open().add(
        std::make_shared<XrdsDevice>(xrds::openGpu(optionsOf(given)), given.preparation, given.preparationUser));
    return XRDS_OK;
  });
}

XrdsResult xrdsDescribeOpenDevice(XrdsDevice* device, XrdsDeviceDescription* description) {
  return guarded([&] {
    checkedSize(required(description, "description"));
    const auto found = Devices::open().opened(device, "device");
    const std::lock_guard lock(found->access);
    describe(xrds::descriptionOf(found->gpu), *description);
    return XRDS_OK;
  });
}

void xrdsCloseDevice(XrdsDevice* device) {
  guarded([&] {
    Devices::open().remove(device);
    return XRDS_OK;
  });
}

const char* xrdsGetDeviceNote(XrdsDevice* device, uint32_t index) {
  const auto found = Devices::open().find(device);
  return found && index < found->gpu.notes().size() ? found->gpu.notes()[index].c_str() : nullptr;
}

const char* xrdsGetKernelFamily(uint32_t index) {
  const auto names = xrds::kernelFamilyNames();
  return index < names.size() ? names[index] : nullptr;
}
