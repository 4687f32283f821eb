#pragma once

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <optional>
#include <string>
#include <utility>

#include "python/native/call.h"

namespace xrds::python {

using Text = std::optional<std::string>;

inline const char* textOf(const Text& text) { return text ? text->c_str() : nullptr; }

template <class Handle, void (*closeOne)(Handle*)>
void closeHandle(void* handle) {
  closeOne(static_cast<Handle*>(handle));
}

inline nb::dict fieldsOf(const XrdsDeviceDescription& found) {
  nb::dict fields;
  fields["name"] = found.name;
  fields["kind"] = found.kind;
  fields["uuid"] = found.uuid;
  fields["driver"] = found.driver;
  fields["api_version"] = found.apiVersion;
  fields["kernel_family"] = found.kernelFamily;
  fields["memory"] = found.memoryBytes;
  return fields;
}

/// An open device.
class Device {
 public:
  Device(const Text& select, const Text& cacheFolder, const Text& kernelFamily, nb::handle progress) {
    Call call(progress);
    XrdsDeviceOptions options = xrdsDeviceOptionsDefault();
    options.select = textOf(select);
    options.cacheFolder = textOf(cacheFolder);
    options.kernelFamily = textOf(kernelFamily);
    options.preparation = Call::hearPreparation;
    call.run([&] { return xrdsOpenDevice(&options, &handle_); });
  }
  ~Device() { close(); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  void close() {
    if (handle_) Call::close(closeHandle<XrdsDevice, xrdsCloseDevice>, std::exchange(handle_, nullptr));
  }
  nb::dict fields() const {
    XrdsDeviceDescription found{.structSize = sizeof found};
    XrdsDevice* const device = handle();
    Call call;
    call.run([&] { return xrdsDescribeOpenDevice(device, &found); });
    return fieldsOf(found);
  }
  /// Raises ArgumentError if it was closed: under Python's lock alone, not within Call::run().
  XrdsDevice* handle() const { return opened(handle_, "device"); }

 private:
  XrdsDevice* handle_ = nullptr;
};

}  // namespace xrds::python
