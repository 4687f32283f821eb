#include "graph/promotion.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "checks/stress/edges.h"
#include "network/network_model.h"

namespace xrds {
namespace {

const NetworkConfig kSmall{.scale = 2, .channels = 16, .auxChannels = 8, .groups = 2, .blocks = 1, .headChannels = 8};

NetworkModel changed(const std::string& edge) {
  const NetworkModel model = NetworkModel::random(kSmall, 3);
  for (const WeightEdge& known : weightEdges())
    if (known.name == edge) return NetworkModel::fromTensors(known.apply(model.file()), "test");
  throw std::logic_error("no edge " + edge);
}

Graph graphOf(const NetworkModel& model, Precision precision) {
  return buildGraph(model.config(), {9, 7}, model.lookup(), {.precision = precision});
}

std::vector<std::string> promotedNames(const NetworkModel& model, bool weights) {
  std::vector<std::string> names;
  for (const Promotion& promotion : graphOf(model, Precision::fp16).promoted)
    if (promotion.weights == weights) names.push_back(promotion.name);
  return names;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

TEST(Promotion, LeavesOrdinaryWeightsAlone) { EXPECT_TRUE(promotedNames(changed("as they are"), false).empty()); }

TEST(Promotion, NeverTouchesFp32) { EXPECT_TRUE(graphOf(changed("inside x 2^20"), Precision::fp32).promoted.empty()); }

TEST(Promotion, StoresInFp32WhatIsTooLargeForAHalf) {
  const NetworkModel model = changed("inside x 2^20");
  const auto values = promotedNames(model, false), weights = promotedNames(model, true);
  EXPECT_TRUE(contains(values, "aux_blocks.0.conv1"));
  EXPECT_TRUE(contains(values, "groups.0.xm.self_attn.qkv"));
  EXPECT_TRUE(contains(values, "groups.0.xm.self_attn"));  // the heads that attention makes of the values
  EXPECT_FALSE(contains(values, "groups.0.xm.mlp.fc1"));
  EXPECT_TRUE(contains(weights, "aux_blocks.0.conv2"));  // so small that a half has few digits left
  for (const Value& value : graphOf(model, Precision::fp16).values) {
    if (value.name == "aux_blocks.0.conv1") {
      EXPECT_EQ(value.type, DataType::f32);
    }
    if (value.name == "groups.0.xm.mlp.fc1") {
      EXPECT_EQ(value.type, DataType::f16);
    }
  }
}

TEST(Promotion, StoresInFp32WhatIsTooSmallForAHalf) {
  const NetworkModel model = changed("inside x 2^-24");
  const auto values = promotedNames(model, false), weights = promotedNames(model, true);
  EXPECT_TRUE(contains(values, "aux_blocks.0.conv1"));
  EXPECT_TRUE(contains(weights, "aux_blocks.0.conv1"));
  // A third of the layer's outputs alone is small.
  EXPECT_TRUE(contains(values, "groups.0.xm.self_attn.qkv"));
  EXPECT_TRUE(contains(weights, "groups.0.xm.self_attn.qkv"));
}

TEST(Promotion, StoresQueriesAndKeysOfLargeLogitsInFp32) {
  const auto values = promotedNames(changed("logits x 1e6"), false);
  EXPECT_TRUE(contains(values, "groups.1.xm.self_attn.qkv"));
  EXPECT_TRUE(contains(values, "groups.1.xm.cross_attn.q"));
  EXPECT_TRUE(contains(values, "groups.1.xm.cross_attn.kv"));
  EXPECT_FALSE(contains(values, "lr_conv"));
}

}  // namespace
}  // namespace xrds
