#include "bench/operator_case.h"

#include <gtest/gtest.h>

#include <set>

#include "bench/peaks.h"
#include "shaders/programs.h"
#include "tests/harness.h"

namespace xrds::bench {
namespace {

const NetworkConfig kSmall{.channels = 16, .auxChannels = 8, .groups = 1, .blocks = 1, .headChannels = 16};

// A device of its own, whose programs are those of `source`.
Gpu gpuWith(ProgramSource source) {
  DeviceOptions options = test::gpuOptions();
  options.programs = std::move(source);
  return Gpu(std::move(options));
}

TEST(OperatorCase, HoldsEveryNodeOfTheGraph) {
  const NetworkModel model = NetworkModel::random(kSmall, 1);
  const auto cases = distinctOperators("small", model, 64, Precision::fp32, test::gpu().traits());
  uint32_t nodes = 0;
  std::set<std::string> names;
  for (const OperatorCase& operatorCase : cases) {
    nodes += operatorCase.nodesPerFrame;
    names.insert(operatorCase.name);
    EXPECT_GT(workOf(operatorCase, test::gpu().traits()).byteSize, 0U) << operatorCase.name;
  }
  EXPECT_EQ(nodes, buildGraph(kSmall, {16, 16}, model.lookup(), fastOn(test::gpu().traits(), {})).nodes.size());
  EXPECT_EQ(names.size(), cases.size());
  EXPECT_LT(cases.size(), nodes);
  EXPECT_TRUE(names.contains("linear/small/fp32/groups.0.xm.self_attn.qkv"));
}

TEST(OperatorCase, TakesFramesThatAreComputedInBandsInOnePiece) {
  const NetworkModel model = NetworkModel::random(kSmall, 1);
  const FrameShape frame{256, 256};
  ASSERT_GT(buildGraph(kSmall, frame, model.lookup(), {}).nodes.size(),
            buildGraph(kSmall, {16, 16}, model.lookup(), {}).nodes.size());
  const auto& traits = test::gpu().traits();
  EXPECT_EQ(distinctOperators("small", model, 1024, Precision::fp32, traits).size(),
            distinctOperators("small", model, 64, Precision::fp32, traits).size());
}

TEST(OperatorCase, CountsEachTensorOnce) {
  const NetworkModel model = NetworkModel::random(kSmall, 1);
  for (const auto& operatorCase : distinctOperators("small", model, 64, Precision::fp16, test::gpu().traits())) {
    if (!operatorCase.name.ends_with("xm.self_attn.qkv")) continue;
    const OperatorWork work = workOf(operatorCase, test::gpu().traits());
    EXPECT_EQ(work.multiplyAdds, 16U * 16 * 16 * 48);
    EXPECT_EQ(work.products, work.multiplyAdds);
    EXPECT_EQ(work.byteSize, 2U * (16 * 16 * 16 + 16 * 16 * 48 + 16 * 48 + 48));
    EXPECT_EQ(operatorCase.shapes, "16x16x16 -> 16x16x48");
    return;
  }
  FAIL() << "the network has no such node";
}

TEST(OperatorCase, AgreesWithTheReferenceInBothPrecisions) {
  const NetworkModel model = NetworkModel::random(kSmall, 1);
  for (const Precision precision : {Precision::fp32, Precision::fp16})
    for (const auto& operatorCase : distinctOperators("small", model, 64, precision, test::gpu().traits())) {
      const OperatorError error = compareWithReference(test::gpu(), operatorCase);
      EXPECT_TRUE(error.withinTolerance) << operatorCase.name << " " << error.rms << " " << error.max;
    }
}

TEST(OperatorCase, FindsAWrongKernel) {
  // Half floats where floats are expected.
  Gpu gpu = gpuWith([](std::string_view name) {
    std::string other(name);
    if (name.starts_with("window_attention_")) other.replace(other.size() - 3, 3, "f16");
    return embeddedProgram(other);
  });
  const NetworkModel model = NetworkModel::random(kSmall, 1);
  int wrong = 0;
  for (const auto& operatorCase : distinctOperators("small", model, 64, Precision::fp32, gpu.traits())) {
    const bool attention = operatorCase.name.starts_with("window_attention/");
    if (!attention && !operatorCase.name.starts_with("exposure/")) continue;
    EXPECT_EQ(compareWithReference(gpu, operatorCase).withinTolerance, !attention) << operatorCase.name;
    wrong += attention;
  }
  EXPECT_GT(wrong, 0);
}

TEST(Peaks, AreMeasured) {
  Gpu gpu = gpuWith(peakProgram);
  const DevicePeaks peaks = measurePeaks(gpu);
  EXPECT_GT(peaks.flops, 1e8);
  EXPECT_LT(peaks.flops, 1e15);
  EXPECT_GT(peaks.bytesPerSecond, 1e7);
  EXPECT_LT(peaks.bytesPerSecond, 1e14);
}

}  // namespace
}  // namespace xrds::bench
