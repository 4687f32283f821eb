// The short form of `xrds bench stress`, and the ledger that it holds operators to.
#include "graph/stress/stress.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "graph/error_ledger.h"
#include "graph/stress/edges.h"
#include "graph/stress/inputs.h"
#include "tests/harness.h"

namespace xrds {
namespace {

TEST(Stress, ShortFormMeetsEveryBar) {
  const StressReport report = runStress(test::gpu(), {}, {.shortForm = true});
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

TEST(ErrorLedger, HasABudgetForEveryOperatorOfEveryModel) {
  std::set<std::string> programs;
  for (const NetworkConfig& config : stressConfigs()) {
    const ModelWeights model = ModelWeights::random(config, 1);
    for (const uint32_t bandRows : {config.window, kWholeFrame})
      for (const Node& node : buildGraph(config, {19, 7}, model.lookup(), {.bandRows = bandRows}).nodes) {
        const ErrorBudget budget = ledgerEntry(node.op).budget;
        EXPECT_GT(budget.fp32, 0) << node.name;
        EXPECT_LE(budget.fp32, budget.fp16) << node.name;
        EXPECT_LT(budget.fp16, kNetworkBudget.fp16) << node.name;
        programs.insert(std::visit([](const auto& op) { return dispatch(op, DeviceTraits{}).program; }, node.op));
      }
  }
  EXPECT_TRUE(programs.contains("box_mean_copy_f32"));  // what bands alone have
}

}  // namespace
}  // namespace xrds
