#include "engine/device_traits.h"

#include <algorithm>
#include <string>

#include "xrds/error.h"

namespace xrds {
namespace {
constexpr const char* kFamilies[] = {"plain", "lane", "tile", "matrix", "fused"};

// "plain, lane or tile", of all.
std::string choiceOfFamilies() {
  std::string text = kFamilies[0];
  for (size_t i = 1; i < std::size(kFamilies); ++i)
    text += (i + 1 < std::size(kFamilies) ? ", " : " or ") + std::string(kFamilies[i]);
  return text;
}
}  // namespace

const char* nameOf(KernelFamily family) { return kFamilies[static_cast<size_t>(family)]; }

std::span<const char* const> kernelFamilyNames() { return kFamilies; }

const char* nameOf(MatrixUnits units) {
  static constexpr const char* kNames[] = {"none", "software", "nv", "khr"};
  return kNames[static_cast<size_t>(units)];
}

KernelFamily kernelFamilyOf(std::string_view name) {
  const auto found = std::find(std::begin(kFamilies), std::end(kFamilies), name);
  if (found == std::end(kFamilies))
    throw InvalidArgument("There is no kernel family '" + std::string(name) + "'; choose " + choiceOfFamilies() + ".");
  return static_cast<KernelFamily>(found - std::begin(kFamilies));
}

std::vector<uint32_t> subgroupSizes(const DeviceTraits& device) {
  std::vector<uint32_t> sizes;
  for (uint32_t size = device.leastSubgroup; size > 0 && size <= device.mostSubgroup; size *= 2)
    if (size != device.subgroupSize && uint64_t{size} * device.maxGroupSubgroups >= device.maxGroupInvocations)
      sizes.push_back(size);
  return sizes;
}

}  // namespace xrds
