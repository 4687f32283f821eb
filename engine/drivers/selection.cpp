#include "engine/drivers/selection.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <sstream>

#include "xrds/error.h"

namespace xrds {
namespace {

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

bool isAll(std::string_view text, int (*belongs)(int)) {
  return std::all_of(text.begin(), text.end(), [belongs](unsigned char c) { return belongs(c) != 0; });
}

std::string listed(std::span<const DeviceDescription> devices) {
  std::string text;
  for (const auto& device : devices)
    text += (text.empty() ? "" : ", ") + std::to_string(device.index) + ": " + device.name + " (" + device.uuid + ")";
  return text;
}

size_t only(std::span<const DeviceDescription> devices, const std::vector<size_t>& matches, std::string_view select) {
  if (matches.size() == 1) return matches[0];
  std::ostringstream text;
  if (matches.empty()) {
    text << "No Vulkan device matches \"" << select << "\"; choose one of " << listed(devices)
         << " by its index, a part of its name or its UUID.";
    throw Error(text.str());
  }
  std::vector<DeviceDescription> several;
  several.reserve(matches.size());
  for (const size_t match : matches) several.push_back(devices[match]);
  text << "More than one Vulkan device matches \"" << select << "\": " << listed(several)
       << "; choose one by its index or UUID.";
  throw Error(text.str());
}

}  // namespace

size_t selectDevice(std::span<const DeviceDescription> devices, std::string_view select) {
  if (devices.empty())
    throw Error(
        "No Vulkan 1.2 device with a compute queue was found; install the graphics driver of your GPU, or "
        "Mesa's lavapipe to run on the CPU.");
  if (select.empty()) {
    // DeviceKind is ordered from the best to the last resort, but for `other`, of which nothing is known.
    const auto better = [](const auto& a, const auto& b) { return a.kind < b.kind; };
    return static_cast<size_t>(std::min_element(devices.begin(), devices.end(), better) - devices.begin());
  }

  std::string lower = lowerCase(select);
  std::string hexadecimal = lower;
  std::erase(hexadecimal, '-');
  const bool isIndex = lower.size() <= 2 && isAll(lower, std::isdigit);
  const bool isUuid = hexadecimal.size() == 32 && isAll(hexadecimal, std::isxdigit);

  std::vector<size_t> exact, partial;
  for (size_t i = 0; i < devices.size(); ++i) {
    const std::string name = lowerCase(devices[i].name);
    if (isIndex ? devices[i].index == static_cast<uint32_t>(std::stoi(lower))
                : (isUuid ? devices[i].uuid == hexadecimal : name == lower))
      exact.push_back(i);
    else if (!isIndex && !isUuid && name.find(lower) != std::string::npos)
      partial.push_back(i);
  }
  return only(devices, exact.empty() ? partial : exact, select);
}

void checkDriver(const DeviceDescription& device) {
  int major = 0, minor = 0;
  if (std::sscanf(device.driver.c_str(), "MoltenVK %d.%d", &major, &minor) != 2) return;
  if (major > 1 || (major == 1 && minor >= 3)) return;
  throw Error(device.driver + " of " + device.name +
              " computes kernels of the wrong size; install MoltenVK 1.3 or newer, or choose another device.");
}

}  // namespace xrds
