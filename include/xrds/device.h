#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "xrds/call.h"
#include "xrds/preparation.h"

struct XrdsVulkanDevice;  // xrds/xrds_vulkan.h

namespace xrds {

/// A Vulkan 1.2 device, opened for compute.
class Device {
 public:
  struct Description {
    std::string name;
    std::string kind;  // "discrete", "integrated", "virtual", "cpu" or "other"
    std::string uuid;  // 32 hexadecimal digits
    std::string driver, apiVersion;
    uint64_t memoryBytes = 0;
    std::string kernelFamily;  // see Options; of an open device what it runs, else what it would
  };
  struct Options {
    /// Empty: the best device. Else its index in list(), a part of its name, or its UUID.
    std::string select{};
    /// Where compiled programs are kept; empty: the user's cache folder. If it cannot be written, a temporary folder
    /// of the user's takes its place: see notes().
    std::filesystem::path cacheFolder{};
    /// The version of the kernels, to compare them: one of kernelFamilies(). Empty: what the environment variable
    /// XRDS_KERNEL_FAMILY names, else what suits the device.
    std::string kernelFamily{};
    /// Vulkan validation layers; their messages go to onMessage.
    bool validation = false;
    std::function<void(std::string_view)> onMessage{};
    /// Hears how far the device is while programs are made: when it is opened, and when an Upscaler is.
    PreparationProgress onPreparation{};
  };

  /// All devices; the index is what Options::select takes. Throws Error if there is no Vulkan loader, or if
  /// XRDS_KERNEL_FAMILY names no family.
  static std::vector<Description> list();

  /// The versions of the kernels: "plain", which runs anywhere, "lane" for CPU devices, "tile" for GPUs, "matrix" and
  /// "fused" for matrix units.
  static std::vector<std::string> kernelFamilies();

  /// Throws Error if no device fits, naming those there are, or if it cannot run the kernels that were asked for.
  explicit Device(const Options& options);
  Device() : Device(Options{}) {}
  Device(Device&&) noexcept = default;
  Device& operator=(Device&& other) noexcept {
    handle_ = std::move(other.handle_);  // closed before its listener goes
    listener_ = std::move(other.listener_);
    return *this;
  }
  Description description() const;
  /// What a user should know of how the device was opened, a sentence each: a cache folder that cannot be written.
  std::vector<std::string> notes() const;

  /// For the functions of the C API; valid as long as the device is open.
  XrdsDevice* handle() const { return handle_.get(); }
  /// Throws what a listener of the options has thrown during a call of this thread, else what the call's result stands
  /// for. What onMessage throws, in whatever thread, comes out of the next call.
  void finish(XrdsResult result) const;

 private:
  friend Device openVulkanDevice(const XrdsVulkanDevice& vulkan, const Options& options);
  friend class Upscaler;  // which hears what the listener throws during its own calls

  // What C calls: behind a pointer, which stays when the device is moved.
  class Listener {
   public:
    explicit Listener(const Options& options) : onPreparation(options.onPreparation), onMessage(options.onMessage) {}
    const PreparationProgress onPreparation;
    const std::function<void(std::string_view)> onMessage;
    // A failure to come out of a call of that thread, or, of no thread, out of the next call of any.
    void keep(std::exception_ptr failure, std::thread::id thread);
    // As finish() of the device.
    void finish(XrdsResult result);

   private:
    std::exception_ptr taken();
    std::mutex access_;
    std::map<std::thread::id, std::exception_ptr> thrown_;
  };
  template <class Open>
  Device(const Options& options, const Open& open);
  static Description described(const XrdsDeviceDescription& found);
  static int hear(void* listener, int machineCode, size_t done, size_t total) noexcept;
  static void listen(void* listener, const char* text) noexcept;

  std::shared_ptr<Listener> listener_;
  call::Owned<XrdsDevice> handle_;  // closed before its listener goes
};

}  // namespace xrds

#include "xrds/device_inline.h"
