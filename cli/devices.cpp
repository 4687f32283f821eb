#include <cstdio>

#include "app/stage.h"
#include "cli/commands.h"
#include "xrds/xrds.h"

namespace xrds {

void addDevices(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("devices", "List the Vulkan devices that --device can choose");
  verb->footer(
      "--device takes the number, a part of the name, or the UUID. Without it the best one is taken: discrete\n"
      "before integrated before virtual before CPU.\n\nExample:\n  xrds devices");
  verb->callback([] {
    const auto devices = stage(ExitCode::device, [] { return Device::list(); });
    if (devices.empty())
      throw Failure{ExitCode::device, "There is no Vulkan 1.2 device: install a driver (Debian: mesa-vulkan-drivers)."};
    for (size_t i = 0; i < devices.size(); ++i) {
      const Device::Description& device = devices[i];
      std::printf("%zu  %s  (%s, Vulkan %s, %.1f GiB)\n   driver %s\n   UUID %s\n   kernels %s\n", i,
                  device.name.c_str(), device.kind.c_str(), device.apiVersion.c_str(),
                  static_cast<double>(device.memoryBytes) / (1 << 30), device.driver.c_str(), device.uuid.c_str(),
                  device.kernelFamily == "matrix" ? "matrix in fp16, tile in fp32" : device.kernelFamily.c_str());
    }
  });
}

}  // namespace xrds
