#pragma once

#include "xrds/device.h"

namespace xrds {

inline std::vector<Device::Description> Device::list() {
  uint32_t count = 0;
  call::check(xrdsCountDevices(&count));
  std::vector<Description> descriptions;
  for (uint32_t i = 0; i < count; ++i) {
    auto found = call::sized<XrdsDeviceDescription>();
    call::check(xrdsDescribeDevice(i, &found));
    descriptions.push_back(described(found));
  }
  return descriptions;
}

inline std::vector<std::string> Device::kernelFamilies() {
  std::vector<std::string> names;
  while (const char* name = xrdsGetKernelFamily(static_cast<uint32_t>(names.size()))) names.emplace_back(name);
  return names;
}

template <class Open>
Device::Device(const Options& options, const Open& open) : listener_(new Listener(options)) {
  const std::string cacheFolder = call::text(options.cacheFolder);
  XrdsDeviceOptions asked = xrdsDeviceOptionsDefault();
  asked.select = options.select.c_str();
  asked.cacheFolder = cacheFolder.c_str();
  asked.kernelFamily = options.kernelFamily.c_str();
  asked.validation = options.validation;
  if (options.onPreparation) asked.preparation = hear;
  if (options.onMessage) asked.message = listen;
  asked.preparationUser = asked.messageUser = listener_.get();
  XrdsDevice* opened = nullptr;
  const XrdsResult result = open(&asked, &opened);
  handle_.reset(opened);
  finish(result);
}

inline Device::Device(const Options& options) : Device(options, xrdsOpenDevice) {}

inline int Device::hear(void* listener, int machineCode, size_t done, size_t total) noexcept {
  auto& self = *static_cast<Listener*>(listener);
  if (machineCode > 1) return 1;  // of a tuning, which upscalers tell of
  try {
    using Phase = Preparation::Phase;
    return self.onPreparation({machineCode ? Phase::machineCode : Phase::pipelines, done, total}) ? 1 : 0;
  } catch (...) {
    self.keep(std::current_exception(), std::this_thread::get_id());
    return 0;
  }
}

inline void Device::listen(void* listener, const char* text) noexcept {
  auto& self = *static_cast<Listener*>(listener);
  try {
    self.onMessage(text);
  } catch (...) {
    self.keep(std::current_exception(), {});
  }
}

inline void Device::Listener::keep(std::exception_ptr failure, std::thread::id thread) {
  const std::lock_guard lock(access_);
  thrown_[thread] = std::move(failure);
}

inline std::exception_ptr Device::Listener::taken() {
  const std::lock_guard lock(access_);
  for (const std::thread::id thread : {std::this_thread::get_id(), std::thread::id()})
    if (const auto node = thrown_.extract(thread)) return node.mapped();
  return nullptr;
}

inline void Device::Listener::finish(XrdsResult result) {
  if (const std::exception_ptr thrown = taken()) std::rethrow_exception(thrown);
  call::check(result);
}

inline void Device::finish(XrdsResult result) const { listener_ ? listener_->finish(result) : call::check(result); }

inline Device::Description Device::described(const XrdsDeviceDescription& found) {
  return {.name = found.name,
          .kind = found.kind,
          .uuid = found.uuid,
          .driver = found.driver,
          .apiVersion = found.apiVersion,
          .memoryBytes = found.memoryBytes,
          .kernelFamily = found.kernelFamily};
}

inline Device::Description Device::description() const {
  auto found = call::sized<XrdsDeviceDescription>();
  call::check(xrdsDescribeOpenDevice(handle(), &found));
  return described(found);
}

inline std::vector<std::string> Device::notes() const {
  std::vector<std::string> notes;
  while (const char* note = xrdsGetDeviceNote(handle(), static_cast<uint32_t>(notes.size()))) notes.emplace_back(note);
  return notes;
}

}  // namespace xrds
