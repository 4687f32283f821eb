// The short form of `xrds bench stress`, and the ledger that it holds operators to.
#include "checks/stress/stress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "checks/error_budget.h"
#include "checks/stress/edges.h"
#include "checks/stress/inputs.h"
#include "engine/kernel_family.h"
#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds {
namespace {

// The shipped models, the golden ones, and the random ones of a stress run.
const std::vector<NetworkModel>& allModels() {
  static const std::vector<NetworkModel> models = [] {
    std::vector<NetworkModel> found;
    for (const std::filesystem::path folder : {XRDS_SOURCE_FOLDER "/models", XRDS_GOLDEN_FOLDER})
      for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name.ends_with(".safetensors") && !name.ends_with(".io.safetensors"))
          found.push_back(NetworkModel::read(entry.path()));
      }
    for (const StressNetwork& network : stressNetworks()) found.push_back(NetworkModel::random(network.config, 1));
    return found;
  }();
  return models;
}

Graph graphOf(const NetworkModel& model, const DeviceTraits& device, Precision precision, uint32_t bandRows) {
  return buildGraph(model.config(), {19, 7}, model.lookup(),
                    fastOn(device, {.precision = precision, .bandRows = bandRows}));
}

// Operators and precisions that devices with these traits run of any model.
std::set<std::pair<std::string, std::string>> operatorsOf(const DeviceTraits& device) {
  std::set<std::pair<std::string, std::string>> found;
  for (const NetworkModel& model : allModels())
    for (const Precision precision : {Precision::fp32, Precision::fp16})
      for (const Node& node : graphOf(model, device, precision, kWholeFrame).nodes)
        found.emplace(factsOf(node).name, nameOf(precision));
  return found;
}

void expectCoversEveryOperator(const StressReport& report, const DeviceTraits& device) {
  std::set<std::pair<std::string, std::string>> checked;
  for (const StressOperator& op : report.operators)
    if (op.family == nameOf(device.family)) checked.emplace(op.name, op.precision);
  for (const auto& [name, precision] : operatorsOf(device))
    EXPECT_TRUE(checked.contains({name, precision})) << name << " in " << precision;
}

TEST(Stress, ShortFormMeetsEveryBarOfEveryOperator) {
  const StressReport report = runStress(test::gpu(), {}, {.shortForm = true});
  expectCoversEveryOperator(report, test::gpu().traits());
  for (const std::string& exception : report.exceptions()) ADD_FAILURE() << exception;
  EXPECT_GT(report.cases(), 250u);
  uint64_t natural = 0, repaired = 0, promoted = 0;
  for (const StressRow& row : report.rows) {
    natural += row.naturalCases;
    repaired += row.repairedPixels;
    promoted += row.promoted.size();
    if (row.precision == "fp32") {
      EXPECT_TRUE(row.promoted.empty());
    }
  }
  EXPECT_GT(natural, 20u);
  EXPECT_GT(repaired, 0u);
  EXPECT_GT(promoted, 0u);
}

TEST(Stress, ShortFormTriesTheFusedLayersOfADeviceThatRunsThem) {
  const DeviceTraits traits = test::gpu().traits();
  test::gpu().setTraits(test::traitsOf(KernelFamily::fused));
  const StressModel folded{"folded", NetworkModel::random(stressConfig("folded"), 1)};  // has layers that are fused
  const StressReport report = runStress(test::gpu(), {folded}, {.randomModels = false, .shortForm = true});
  test::gpu().setTraits(traits);
  for (const std::string& exception : report.exceptions()) ADD_FAILURE() << exception;
  EXPECT_TRUE(std::any_of(report.operators.begin(), report.operators.end(), [](const StressOperator& op) {
    return op.name == "swin_layer" && op.precision == "fp16" && op.family == "fused" && op.worstError > 0;
  }));
}

// What runs without the ceiling draws on black; a row that did is an exception.
TEST(Stress, NamesWhatIsDrawnOnBlackAndWhatDoesNotScale) {
  StressReport report{.fp32ScalingBound = 1e-3};
  report.rows.push_back({.model = "m", .weights = "w", .precision = "fp32", .family = "plain"});
  EXPECT_TRUE(report.exceptions().empty());
  report.rows[0].litFromBlack = 3;
  report.rows[0].worstScaling = 2e-3;
  ASSERT_EQ(report.exceptions().size(), 2u);
  EXPECT_NE(report.exceptions()[0].find("3 pixels of black frames are lit"), std::string::npos);
  EXPECT_NE(report.exceptions()[1].find("0.002"), std::string::npos);
}

TEST(Stress, InputsHoldWhatTheirNamesSay) {
  const auto colours = stressColours();
  for (size_t i = 0; i < colours.size(); ++i) {
    const Image image = stressColour(i, {9, 7}, 1);
    bool finite = true;
    for (const float value : image.pixels) {
      finite = finite && std::isfinite(value);
      EXPECT_TRUE(!colours[i].natural || (value >= 0 && value <= 65504)) << colours[i].name;
    }
    EXPECT_TRUE(finite || !colours[i].natural) << colours[i].name;
    EXPECT_FALSE(finite && colours[i].name.find("NaN") != std::string::npos) << colours[i].name;
    EXPECT_EQ(std::memcmp(image.pixels.data(), stressColour(i, {9, 7}, 1).pixels.data(), 4 * image.pixels.size()), 0);
  }
}

std::string programOf(const Node& node, const DeviceTraits& device) {
  return std::visit([&](const auto& op) { return dispatch(op, device).program; }, node.op);
}

class BudgetsOfFamilies : public testing::TestWithParam<KernelFamily> {};

TEST_P(BudgetsOfFamilies, HasABudgetForEveryOperatorThatDevicesRun) {
  const DeviceTraits device = usualTraits(GetParam());
  for (const NetworkModel& model : allModels())
    for (const Precision precision : {Precision::fp32, Precision::fp16})
      for (const uint32_t bandRows : {model.config().window, kWholeFrame})
        for (const Node& node : graphOf(model, device, precision, bandRows).nodes) {
          const OperatorFacts facts = factsOf(node);
          EXPECT_TRUE(programOf(node, device).starts_with(std::string(facts.name) + "_")) << node.name;
          EXPECT_GT(facts.budget.fp32, 0) << node.name;
          EXPECT_LE(facts.budget.fp32, facts.budget.fp16) << node.name;
          EXPECT_LT(facts.budget.fp16, kNetworkBudget.fp16) << node.name;
        }
}

INSTANTIATE_TEST_SUITE_P(All, BudgetsOfFamilies,
                         testing::Values(KernelFamily::plain, KernelFamily::lane, KernelFamily::tile,
                                         KernelFamily::matrix, KernelFamily::fused),
                         [](const auto& info) { return std::string(nameOf(info.param)); });

TEST(OperatorFacts, KnowsWhatBandsFoldsAndFusedLayersAloneHave) {
  std::set<std::string> programs;
  for (const KernelFamily family : {KernelFamily::lane, KernelFamily::fused})
    for (const Precision precision : {Precision::fp32, Precision::fp16})
      for (const auto& [name, config, inShortForm] : stressNetworks()) {
        const DeviceTraits device = usualTraits(family);
        for (const Node& node : graphOf(NetworkModel::random(config, 1), device, precision, config.window).nodes) {
          programs.insert(programOf(node, device));
        }
      }
  for (const char* program : {"box_mean_copy_f32", "fold_lane_f16", "swin_layer_matrix_khr_f16"})
    EXPECT_TRUE(programs.contains(program)) << program;
}

}  // namespace
}  // namespace xrds
