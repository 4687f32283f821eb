#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "xrds/error.h"
#include "xrds/export.h"
#include "xrds/preparation.h"

namespace xrds {

/// A Vulkan 1.2 device, opened for compute.
class XRDS_API Device {
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
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;
  Description description() const;
  /// What a user should know of how the device was opened, a sentence each: a cache folder that cannot be written.
  std::vector<std::string> notes() const;

 private:
  friend class TemporalFilter;
  friend class Upscaler;
  friend struct EngineAccess;
  friend struct Examination;
  friend struct Tuning;
  struct State;
  explicit Device(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace xrds
