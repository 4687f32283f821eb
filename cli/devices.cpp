#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/failing_with.h"
#include "cli/commands.h"
#include "cli/device_json.h"
#include "cli/json_text.h"
#include "cli/output_file.h"
#include "xrds/xrds.hpp"

namespace xrds {
namespace {

std::string jsonText(const std::vector<Device::Description>& devices) {
  nlohmann::ordered_json json{{"version", XRDS_VERSION}, {"devices", nlohmann::ordered_json::array()}};
  for (size_t i = 0; i < devices.size(); ++i) {
    json["devices"].push_back({{"index", i}});
    json["devices"].back().update(jsonOf(devices[i]));
    json["devices"].back()["kernelFamily"] = devices[i].kernelFamily;
  }
  return textOf(json);
}

void print(const std::vector<Device::Description>& devices) {
  for (size_t i = 0; i < devices.size(); ++i) {
    const Device::Description& device = devices[i];
    std::printf("%zu  %s  (%s, Vulkan %s, %.1f GiB)\n   driver %s\n   UUID %s\n   kernels %s\n", i, device.name.c_str(),
                device.kind.c_str(), device.apiVersion.c_str(), static_cast<double>(device.memoryBytes) / (1 << 30),
                device.driver.c_str(), device.uuid.c_str(),
                device.kernelFamily == "matrix" ? "matrix in fp16, tile in fp32" : device.kernelFamily.c_str());
  }
}

void run(const std::string& jsonFile) {
  requireOutput(jsonFile, ".json", "--json");
  const auto devices = failingWith(ExitCode::device, [] { return Device::list(); });
  if (devices.empty())
    throw Failure{ExitCode::device, "There is no Vulkan 1.2 device: install a driver (Debian: mesa-vulkan-drivers)."};
  print(devices);
  if (!jsonFile.empty()) failingWith(ExitCode::output, [&] { writeText(jsonFile, jsonText(devices)); });
}

}  // namespace

void addDevices(CLI::App& app) {
  const auto jsonFile = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("devices", "List the Vulkan devices that --device can choose");
  verb->add_option("--json", *jsonFile, "Write the list to this file, too")->type_name("JSON");
  verb->footer(
      "--device takes the number, a part of the name, or the UUID. Without it the best one is taken: discrete\n"
      "before integrated before virtual before CPU.\n\nExample:\n  xrds devices");
  verb->callback([jsonFile] { run(*jsonFile); });
}

}  // namespace xrds
