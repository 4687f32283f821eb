#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/device_traits.h"
#include "engine/pace.h"
#include "xrds/preparation.h"

namespace xrds {

enum class DeviceKind : uint8_t { discrete, integrated, virtualGpu, cpu, other };

/// What a Vulkan device says of itself.
struct DeviceDescription {
  uint32_t index = 0;  // in listDevices()
  std::string name;
  DeviceKind kind = DeviceKind::other;
  std::string uuid;          // 32 hexadecimal digits, deviceUUID
  std::string driver;        // driver name and its version text
  std::string apiVersion;    // "1.3.230"
  uint64_t memoryBytes = 0;  // of the largest device-local heap
  MatrixUnits matrixUnits = MatrixUnits::none;
  MatrixSize matrixSize;                            // of their products
  KernelFamily kernelFamily = KernelFamily::plain;  // that suits the device
};

/// Finds the SPIR-V words of a program by its name; empty if there is none.
using ProgramSource = std::function<std::span<const uint32_t>(std::string_view)>;

/// Which device is opened, and how.
struct DeviceOptions {
  /// Empty: the best one (discrete, integrated, virtual, CPU). Else an index, a part of the name, or a UUID.
  std::string select;
  /// Validation and synchronization validation; their messages go to onMessage. Throws if the layer is missing.
  bool validation = false;
  std::function<void(std::string_view)> onMessage;
  /// Pipelines and driver caches are kept here; empty: the user's cache folder. If it cannot be written, a temporary
  /// one takes its place: see Gpu::notes().
  std::filesystem::path cacheFolder;
  /// The written version of the kernels; empty: what $XRDS_KERNEL_FAMILY names, else what suits the device.
  std::string kernelFamily{};
  /// Hears how far the making of programs is, from Recording's constructor.
  PreparationProgress onPreparation{};
  /// Copies through a staging buffer even where the host sees the device's memory, for tests.
  bool forceStaging = false;
  ProgramSource programs;
};

/// Every Vulkan 1.2 device with a compute queue. Throws Error if the machine has no Vulkan loader.
std::vector<DeviceDescription> listDevices();

inline constexpr uint32_t kUsualPatienceSeconds = 300;

struct HostDevice;  // engine/host_device.h

/// An open Vulkan device: instance, queue, compiled programs. One thread at a time.
class Gpu {
 public:
  /// Throws Error if no device fits the selection (it names those there are), it cannot run the kernel family, or
  /// Vulkan fails.
  explicit Gpu(DeviceOptions options);
  /// Shares a program's own device. Of the options `select`, validation and extensions do not count. Throws
  /// InvalidArgument if what was given does not belong together.
  Gpu(DeviceOptions options, const HostDevice& host);
  ~Gpu();
  Gpu(Gpu&&) noexcept;
  Gpu& operator=(Gpu&&) noexcept;

  const DeviceDescription& description() const;
  const DeviceTraits& traits() const;
  /// What a user should know of how it was opened, a sentence each.
  const std::vector<std::string>& notes() const;
  /// Whether the kernel family was asked for, by the options or $XRDS_KERNEL_FAMILY.
  bool hasAskedFamily() const;
  /// Whether it is another program's.
  bool isShared() const;
  /// Where caches are kept; empty: nowhere.
  const std::filesystem::path& cacheFolder() const;
  /// Names device and driver, so that what was found of one is not taken for another: a line.
  std::string driverKey() const;
  /// The SPIR-V of a program, empty if there is none of that name.
  std::span<const uint32_t> program(std::string_view name) const;
  /// How fast the device is, as measured by recordings that ran, in this process or an earlier one.
  Pace pace() const;
  /// How long a submission may take before the device counts as lost. It must be longer than a driver takes to compile
  /// a program.
  void setPatience(uint32_t seconds);
  /// Whether Recording::gpuMicroseconds has anything to say.
  bool hasTimestamps() const;
  /// Overrides the kernel family or limits, for tests that compare families.
  void setTraits(const DeviceTraits& traits);

  struct Handles;  // Vulkan objects; defined in engine/handles.h, for the engine and programs that share its device
  Handles& handles() { return *handles_; }

 private:
  std::unique_ptr<Handles> handles_;
};

}  // namespace xrds
