// No dispatch may ask for more workgroups than every device has in a dimension: 65535.
#include <gtest/gtest.h>

#include <algorithm>

#include "checks/stress/edges.h"
#include "engine/kernel_family.h"
#include "network/network_model.h"
#include "tests/print_case.h"

namespace xrds {
namespace {

constexpr uint32_t kMostGroups = 65535;

std::string gridText(const Dispatch& launch) {
  const auto [x, y, z] = launch.groupCount;
  return launch.program + " of " + std::to_string(x) + " x " + std::to_string(y) + " x " + std::to_string(z);
}

bool isGrid(const Dispatch& launch) {
  return std::all_of(launch.groupCount.begin(), launch.groupCount.end(),
                     [](uint32_t count) { return count >= 1 && count <= kMostGroups; });
}

// The paper's size, that of the shipped compact models, the largest heads and the most of them, and all that a stress
// run tries.
std::vector<NetworkConfig> configs() {
  std::vector<NetworkConfig> all;
  for (const StressNetwork& network : stressNetworks()) {
    all.push_back(network.config);
    all.back().groups = all.back().blocks = 1;
  }
  all.push_back({.groups = 1, .blocks = 1});
  all.push_back({.channels = 32,
                 .auxChannels = 16,
                 .groups = 1,
                 .blocks = 1,
                 .kernels = 5,
                 .auxSkip = true,
                 .auxKernels = 5,
                 .outputSide = 1});
  all.push_back({.scale = 1, .channels = 128, .groups = 1, .blocks = 1, .window = 2, .headChannels = 4});
  all.push_back({.scale = 1, .channels = 128, .groups = 1, .blocks = 1, .window = 16, .headChannels = 128});
  return all;
}

class DispatchGrid : public testing::TestWithParam<KernelFamily> {
 protected:
  // Visits the graph of every network for large outputs: square, as wide and as high as outputs may be.
  static void forEachGraph(const std::function<void(const Graph&)>& visit) {
    for (const NetworkConfig& config : configs()) {
      const NetworkModel model = NetworkModel::random(config, 1);
      const uint32_t s = config.scale;
      for (const FrameShape frame : {FrameShape{8192 / s, 8192 / s}, FrameShape{16 / s + 1, kMaxSide / s},
                                     FrameShape{kMaxSide / s, 16 / s + 1}, FrameShape{kMaxSide / s, 2048 / s}})
        for (const Precision precision : {Precision::fp32, Precision::fp16})
          visit(buildGraph(config, frame, model.lookup(),
                           fastOn(device(), {.precision = precision, .bandRows = kWholeFrame})));
    }
  }
  static DeviceTraits device() { return usualTraits(GetParam()); }
};

// Each operator's, and those that it is lowered to.
TEST_P(DispatchGrid, FitsAnyDevice) {
  forEachGraph([](const Graph& graph) {
    for (const Node& node : graph.nodes) {
      const Dispatch launch = std::visit([](const auto& op) { return dispatch(op, device()); }, node.op);
      EXPECT_TRUE(isGrid(launch)) << gridText(launch) << " for " << node.name;
    }
    for (const LoweredDispatch& lowered : lower(graph, device()))
      EXPECT_TRUE(isGrid(lowered.dispatch)) << gridText(lowered.dispatch) << " for " << lowered.dispatch.label;
  });
}

INSTANTIATE_TEST_SUITE_P(All, DispatchGrid,
                         testing::Values(KernelFamily::plain, KernelFamily::lane, KernelFamily::tile,
                                         KernelFamily::matrix, KernelFamily::fused),
                         [](const auto& info) { return std::string(nameOf(info.param)); });

// Rows whose subgroups cannot be shared out among workgroups, as a residual asks for: 1047 of 125 subgroups each.
TEST(Lower, HalvesRowsWhoseGridWouldBeTooLarge) {
  const std::vector<float> weight(16, 1), bias(4, 0);
  Graph graph;
  const TensorView x = graph.create("x", DataType::f32, {1048, 1000, 4}),
                   residual = graph.create("residual", DataType::f32, x.shape()),
                   y = graph.create("y", DataType::f32, x.shape());
  graph.nodes.push_back(
      {"map",
       Linear{.input = x, .output = y, .residual = residual, .weight = weight, .bias = bias, .rows = {0, 1047}}});
  const DeviceTraits device = usualTraits(KernelFamily::lane);
  const auto lowered = lower(graph, device);
  ASSERT_EQ(lowered.size(), 2u);
  uint64_t work = 0;
  for (const LoweredDispatch& part : lowered) {
    EXPECT_TRUE(isGrid(part.dispatch)) << gridText(part.dispatch);
    EXPECT_EQ(part.dispatch.program, "linear_lane_f32");
    work += part.dispatch.multiplyAdds;
  }
  EXPECT_EQ(work, cost(graph).multiplyAdds);
}

}  // namespace
}  // namespace xrds
