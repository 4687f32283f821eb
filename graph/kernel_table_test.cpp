#include "graph/kernel_table.h"

#include <gtest/gtest.h>

#include <set>

namespace xrds {
namespace {

constexpr KernelFamily kFamilies[] = {KernelFamily::plain, KernelFamily::lane, KernelFamily::tile};
const std::vector<float> kNumbers(96 * 96 * 9, 0.5F);

DeviceTraits cpu() { return {.family = KernelFamily::lane, .shaderInt64 = true}; }

Linear linearOf(uint32_t side, uint32_t inputs, uint32_t outputs) {
  Linear op{.input = {0, DataType::f32, side, side, inputs, 0, inputs},
            .output = {1, DataType::f32, side, side, outputs, 0, outputs}};
  op.weight = std::span(kNumbers).first(size_t{inputs} * outputs);
  op.bias = std::span(kNumbers).first(outputs);
  return op;
}

TEST(KernelTable, AKeyIsOfChannelsAndStorageAlone) {
  const std::string key = operatorKey(linearOf(16, 64, 96));
  EXPECT_EQ(operatorKey(linearOf(64, 64, 96)), key);
  Linear rows = linearOf(64, 64, 96);
  rows.rows = {8, 24};
  EXPECT_EQ(operatorKey(rows), key);
  EXPECT_NE(operatorKey(linearOf(16, 64, 64)), key);
  EXPECT_NE(operatorKey(linearOf(16, 32, 96)), key);
  Linear other = linearOf(16, 64, 96);
  other.activation = Activation::gelu;
  EXPECT_NE(operatorKey(other), key);
  other = linearOf(16, 64, 96);
  other.weightType = DataType::f16;
  EXPECT_NE(operatorKey(other), key);
}

TEST(KernelTable, CandidatesLaunchDifferently) {
  const auto few = candidatesOf(linearOf(32, 64, 96), cpu(), kFamilies, false);
  const auto all = candidatesOf(linearOf(32, 64, 96), cpu(), kFamilies, true);
  ASSERT_EQ(few.size(), 3u);
  EXPECT_EQ(few[0].dispatch.program, "linear_lane_f32") << "the device's own is the first";
  EXPECT_GT(all.size(), few.size());
  std::set<std::pair<std::string, std::vector<uint32_t>>> seen;
  for (const KernelCandidate& each : all)
    EXPECT_TRUE(seen.emplace(each.dispatch.program, each.dispatch.specialization).second) << each.dispatch.program;
}

// Those of RDNA: pipelines choose between 32 and 64.
TEST(KernelTable, SubgroupsOfOtherSizesAreTried) {
  DeviceTraits gpu{.family = KernelFamily::matrix, .matrixUnits = MatrixUnits::khr, .subgroupSize = 64};
  Linear op = linearOf(32, 64, 96);
  op.input.type = op.output.type = op.weightType = DataType::f16;
  constexpr KernelFamily kOfGpus[] = {KernelFamily::plain, KernelFamily::tile, KernelFamily::matrix};
  const auto askedOf = [&](bool shapes) {
    std::map<std::string, std::set<uint32_t>> asked;
    for (const KernelCandidate& each : candidatesOf(op, gpu, kOfGpus, shapes)) {
      EXPECT_TRUE(each.kernel.shape.subgroup == 0 || each.dispatch.subgroupSize == each.kernel.shape.subgroup);
      if (each.dispatch.fullSubgroups) {
        EXPECT_EQ(each.dispatch.specialization[0] * each.dispatch.subgroupSize, each.dispatch.specialization[9]);
      }
      asked[each.dispatch.program].insert(each.dispatch.subgroupSize);
    }
    return asked;
  };
  using Asked = std::map<std::string, std::set<uint32_t>>;
  const Asked one{{"linear_plain_f16", {0}}, {"linear_tile_f16", {0}}, {"linear_matrix_khr_f16", {64}}};
  const Asked both{{"linear_plain_f16", {0, 32}}, {"linear_tile_f16", {0, 32}}, {"linear_matrix_khr_f16", {32, 64}}};
  EXPECT_EQ(askedOf(true), one);
  gpu.leastSubgroup = 32;
  gpu.mostSubgroup = 64;
  gpu.maxGroupSubgroups = 32;
  EXPECT_EQ(askedOf(true), both);
  EXPECT_EQ(askedOf(false), one);
  gpu.maxGroupSubgroups = 16;  // in which 32 make no workgroup of 1024
  EXPECT_EQ(askedOf(true), one);
}

// A family that has no kernel for the operator would launch the plain one again.
TEST(KernelTable, ACandidateIsNoFallback) {
  Linear normed = linearOf(32, 64, 96);
  normed.norm = {std::span(kNumbers).first(64), std::span(kNumbers).first(64)};
  std::set<std::string> programs;
  for (const KernelCandidate& each : candidatesOf(normed, cpu(), kFamilies, false))
    EXPECT_TRUE(programs.insert(each.dispatch.program).second);
  EXPECT_EQ(programs, (std::set<std::string>{"linear_lane_f32", "linear_plain_f32"}));
}

TEST(KernelTable, ChoosesForTheNodesThatItHas) {
  Graph graph;
  graph.nodes = {{"a", linearOf(32, 64, 96)}, {"b", linearOf(32, 32, 64)}};
  KernelTable table;
  table.kernels[operatorKey(graph.nodes[0].op)] = {KernelFamily::tile, {.rows = 2}};
  chooseKernels(graph, table);
  EXPECT_EQ(dispatchOf(graph.nodes[0], cpu()).program, "linear_tile_f32");
  EXPECT_EQ(dispatchOf(graph.nodes[0], cpu()).specialization[2], 2u);
  EXPECT_EQ(dispatchOf(graph.nodes[1], cpu()).program, "linear_lane_f32");
  EXPECT_FALSE(table.isFixed());
}

}  // namespace
}  // namespace xrds
