#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "xrds/error.h"

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
    std::string kernelFamily;  // see Options; of an open device, what it runs
  };
  struct Options {
    /// Empty: the best device. Else its index in list(), a part of its name, or its UUID.
    std::string select{};
    /// Where compiled pipelines are kept; empty: the user's cache folder.
    std::filesystem::path cacheFolder{};
    /// The version of the kernels, to compare them: "plain", "lane" (CPU devices), "tile" or "matrix". Empty: what the
    /// environment variable XRDS_KERNEL_FAMILY names, else what suits the device.
    std::string kernelFamily{};
    /// Vulkan validation layers; their messages go to onMessage.
    bool validation = false;
    std::function<void(std::string_view)> onMessage{};
    /// Vulkan extensions to enable, for a program that draws on the same device (xrds/engine_access.h).
    std::vector<std::string> instanceExtensions{}, deviceExtensions{};
  };

  /// All devices; the index is what Options::select takes. Throws Error if there is no Vulkan loader.
  static std::vector<Description> list();

  /// The names that Options::kernelFamily takes, whether or not a device can run them.
  static std::vector<std::string> kernelFamilies();

  /// Throws Error if no device fits, naming those there are.
  explicit Device(const Options& options);
  Device() : Device(Options{}) {}
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;
  Description description() const;

 private:
  friend class Upscaler;
  friend struct EngineAccess;
  friend struct Examination;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace xrds
