// Devices with the least that Vulkan promises, or little more: what they are given is legal, or an error names the
// limit.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/kernel_family.h"
#include "frames/session.h"
#include "tests/print_case.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint32_t kMostGroups = 65535, kMostTexels = 65536, kLeastShared = 16384, kLeastInvocations = 128;
constexpr uint64_t kStorageRange = uint64_t{128} << 20;

struct SmallDevice {
  const char* name;
  uint32_t sharedBytes, invocations, subgroupSize;
};

void PrintTo(const SmallDevice& device, std::ostream* out) { *out << device.name; }

constexpr SmallDevice kDevices[] = {{"least", kLeastShared, kLeastInvocations, 8},
                                    {"least_of_64", kLeastShared, kLeastInvocations, 64},
                                    {"least_of_128", kLeastShared, kLeastInvocations, 128},
                                    {"little_shared", kLeastShared, 1024, 32},
                                    {"few_invocations", 32768, 256, 16},
                                    {"subgroups_of_8", 32768, 1024, 8},
                                    {"subgroups_of_64", 65536, 1024, 64},
                                    {"subgroups_of_128", 32768, 1024, 128}};

DeviceTraits traitsOf(const SmallDevice& small, KernelFamily family) {
  DeviceTraits device = usualTraits(family);
  device.maxSharedBytes = small.sharedBytes;
  device.maxGroupInvocations = small.invocations;
  device.subgroupSize = small.subgroupSize;
  device.maxStorageBufferRange = kStorageRange;
  device.maxTexelBufferElements = kMostTexels;
  return device;
}

// Invocations of a workgroup; 0: of a program whose groups have the same size everywhere.
uint64_t invocationsOf(const Dispatch& launch) {
  const auto isOf = [&](const char* part) { return launch.program.find(part) != std::string::npos; };
  const auto& constants = launch.specialization;
  if (isOf("_matrix_")) return constants[9];
  if (isOf("conv3x3_tile")) return uint64_t{constants[0]} * constants[1] * constants[2];
  if (isOf("linear_tile") || isOf("layer_norm_tile")) return uint64_t{constants[0]} * constants[1];
  if (isOf("window_attention_tile") || isOf("exposure")) return constants[0];
  return 0;
}

void expectLegal(const Dispatch& launch, const DeviceTraits& device) {
  const auto& [x, y, z] = launch.groupCount;
  EXPECT_LE(std::max({x, y, z}), kMostGroups) << launch.program;
  EXPECT_LE(invocationsOf(launch), device.maxGroupInvocations) << launch.program;
  if (launch.fullSubgroups) {
    EXPECT_EQ(launch.subgroupSize, device.subgroupSize) << launch.program;
    EXPECT_EQ(launch.specialization[0] * launch.subgroupSize, invocationsOf(launch)) << launch.program;
  }
  for (const Binding& binding : launch.bindings) {
    if (binding.kind == BindingKind::storage) {
      EXPECT_LE(binding.byteSize, device.maxStorageBufferRange) << launch.program;
    } else if (isTexelBuffer(binding.kind)) {
      EXPECT_LE(binding.byteSize / (4 * byteSize(binding.type)), device.maxTexelBufferElements) << launch.program;
    }
  }
}

class SmallDevices : public testing::TestWithParam<std::tuple<SmallDevice, KernelFamily>> {
 protected:
  // Of the paper's widths, and of the shipped compact models.
  static std::vector<NetworkConfig> configs() {
    NetworkConfig compact{.channels = 32, .auxChannels = 16, .auxSkip = true};
    std::vector<NetworkConfig> all{{}, compact};
    for (NetworkConfig& config : all) config.groups = config.blocks = 1;
    return all;
  }
};

TEST_P(SmallDevices, AreGivenLegalDispatches) {
  const DeviceTraits device = traitsOf(std::get<0>(GetParam()), std::get<1>(GetParam()));
  for (const NetworkConfig& config : configs()) {
    const NetworkModel model = NetworkModel::random(config, 1);
    for (const Precision precision : {Precision::fp16, Precision::fp32}) {
      const Graph graph = buildGraph(config, {16, 16}, model.lookup(), fastOn(device, {.precision = precision}));
      EXPECT_NO_THROW(checkBindings(graph, device));
      for (const LoweredDispatch& lowered : lower(graph, device)) expectLegal(lowered.dispatch, device);
    }
  }
}

TEST_P(SmallDevices, AreToldWhichLimitALargeFrameMeets) {
  const DeviceTraits device = traitsOf(std::get<0>(GetParam()), std::get<1>(GetParam()));
  for (const NetworkConfig& config : configs()) {
    const NetworkModel model = NetworkModel::random(config, 1);
    const Graph graph = buildGraph(config, {512, 512}, model.lookup(), fastOn(device, {.precision = Precision::fp16}));
    try {
      checkBindings(graph, device);
      FAIL() << "a tensor of 512 x 512 pixels has more than 65536 texels";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("at most 65536 texels"), std::string::npos) << error.what();
    }
  }
}

// Large enough for more than 128 MiB of rows to be stored.
TEST_P(SmallDevices, BindNoMoreThanTheirRange) {
  DeviceTraits device = traitsOf(std::get<0>(GetParam()), std::get<1>(GetParam()));
  device.maxTexelBufferElements = uint64_t{1} << 27;
  const NetworkConfig config = configs()[0];
  const NetworkModel model = NetworkModel::random(config, 1);
  const Graph graph = buildGraph(config, {640, 512}, model.lookup(), fastOn(device, {.bandRows = kWholeFrame}));
  EXPECT_NO_THROW(checkBindings(graph, device));
  for (const LoweredDispatch& lowered : lower(graph, device)) expectLegal(lowered.dispatch, device);
}

INSTANTIATE_TEST_SUITE_P(All, SmallDevices,
                         testing::Combine(testing::ValuesIn(kDevices),
                                          testing::Values(KernelFamily::plain, KernelFamily::tile, KernelFamily::matrix,
                                                          KernelFamily::fused)),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param).name) + "_" + nameOf(std::get<1>(info.param));
                         });

}  // namespace
}  // namespace xrds
