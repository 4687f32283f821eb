// Memory aliasing and replay: the plan must not change a single bit of the picture.
#include "frames/session.h"

#include <gtest/gtest.h>

#include "checks/reference.h"
#include "checks/stress/edges.h"
#include "network/architecture.h"
#include "tests/harness.h"
#include "tests/noise_frame.h"
#include "tests/print_case.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using Frame = test::NoiseFrame;

// "full" of the stress, with its auxiliary images as they come.
const NetworkConfig kSmall = [] {
  NetworkConfig config = stressConfig("full");
  config.auxKernels = 0;
  return config;
}();

// kSmall with each kind of block; those that are not the paper's filter the auxiliary images, rdb joins by
// concatenation.
NetworkConfig smallOf(BlockKind block) {
  NetworkConfig config = kSmall;
  config.block = block;
  if (block == BlockKind::rdb) config.cross = CrossKind::concat, config.auxKernels = 5;
  if (block == BlockKind::rstb) config.auxKernels = 3;
  return config;
}

class Aliasing : public testing::TestWithParam<std::tuple<BlockKind, Precision, KernelFamily>> {};

TEST_P(Aliasing, NeverChangesABit) {
  const auto [block, precision, family] = GetParam();
  const NetworkConfig config = smallOf(block);
  Gpu& gpu = test::gpu();
  const DeviceTraits traits = gpu.traits();
  DeviceTraits wanted = traits;
  wanted.family = family;
  wanted.maxStorageBufferRange = 64 * 1024;  // forces row bands as well
  gpu.setTraits(wanted);
  const NetworkModel model = NetworkModel::random(config, 3);
  const FrameShape shape{22, 29};
  Frame frame(config, shape);
  Session aliased(gpu, model, shape, {.precision = precision});
  Session unaliased(gpu, model, shape, {.precision = precision, .aliasing = false});
  gpu.setTraits(traits);
  Session unbanded(gpu, model, shape, {.precision = precision});
  std::vector<float> expected(frame.output.size()), again(frame.output.size());
  ASSERT_TRUE(unaliased.run(frame.input(), expected));
  aliased.fillArena(0xffffffff);
  ASSERT_TRUE(aliased.run(frame.input(), frame.output));
  EXPECT_EQ(frame.output, expected);
  ASSERT_TRUE(aliased.run(frame.input(), again));
  EXPECT_EQ(again, expected);
  if (family == traits.family) {
    ASSERT_TRUE(unbanded.run(frame.input(), again));
    EXPECT_EQ(again, expected);
  }
  EXPECT_LT(aliased.plan().byteSize, unaliased.plan().byteSize / (block == BlockKind::rdb ? 2 : 3));
}

INSTANTIATE_TEST_SUITE_P(Session, Aliasing,
                         testing::Combine(testing::Values(BlockKind::rdst, BlockKind::rdb, BlockKind::rstb),
                                          testing::Values(Precision::fp32, Precision::fp16),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane)));
INSTANTIATE_TEST_SUITE_P(OfGpus, Aliasing,
                         testing::Values(std::tuple{BlockKind::rdst, Precision::fp16, KernelFamily::tile}));

// The architectures that have a small network.
std::vector<const char*> namesOfOthers() {
  std::vector<const char*> names;
  for (const Architecture* architecture : kArchitectures)
    if (architecture->small) names.push_back(architecture->name);
  return names;
}

class Banding : public testing::TestWithParam<std::tuple<const char*, Precision, KernelFamily>> {};

TEST_P(Banding, NeverChangesABit) {
  const auto [which, precision, family] = GetParam();
  const NetworkConfig config = stressConfig(which);
  Gpu& gpu = test::gpu();
  const DeviceTraits traits = gpu.traits();
  DeviceTraits wanted = traits;
  wanted.family = family;
  gpu.setTraits(wanted);
  const NetworkModel model = NetworkModel::random(config, 3);
  const FrameShape shape{30, 13};
  Frame frame(config, shape);
  std::vector<float> expected(frame.output.size());
  Session whole(gpu, model, shape, {.precision = precision, .bandRows = kWholeFrame});
  ASSERT_TRUE(whole.run(frame.input(), expected));
  EXPECT_TRUE(whole.graph().network.exists());
  for (const uint32_t bandRows : {4u, 12u, 28u}) {
    Session banded(gpu, model, shape, {.precision = precision, .bandRows = bandRows});
    EXPECT_GT(banded.graph().nodes.size(), whole.graph().nodes.size());
    banded.fillArena(0xffffffff);
    for (int run = 0; run < 2; ++run) {
      ASSERT_TRUE(banded.run(frame.input(), frame.output));
      EXPECT_EQ(frame.output, expected) << bandRows << " rows, run " << run;
    }
  }
  Session unaliased(gpu, model, shape, {.precision = precision, .bandRows = 8, .aliasing = false});
  unaliased.fillArena(0xffffffff);
  ASSERT_TRUE(unaliased.run(frame.input(), frame.output));
  EXPECT_EQ(frame.output, expected);
  gpu.setTraits(traits);
}

// Every scale, kind of block, way to join and full-resolution stage occurs.
INSTANTIATE_TEST_SUITE_P(Session, Banding,
                         testing::Combine(testing::Values("full", "dense", "plain", "bare"),
                                          testing::Values(Precision::fp32, Precision::fp16),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane)));
INSTANTIATE_TEST_SUITE_P(OtherArchitectures, Banding,
                         testing::Combine(testing::ValuesIn(namesOfOthers()),
                                          testing::Values(Precision::fp32, Precision::fp16),
                                          testing::Values(KernelFamily::lane)));
INSTANTIATE_TEST_SUITE_P(OfGpus, Banding, testing::Values(std::tuple{"full", Precision::fp16, KernelFamily::tile}));

TEST(Session, BandsReadOnlyWhatTheyHold) {
  for (const auto& [name, config, inShortForm] : stressNetworks()) {
    const NetworkModel model = NetworkModel::random(config, 3);
    const FrameShape shape{20, 6};
    const Frame frame(config, shape);
    const CheckResult check = checkAgainstReference(test::gpu(), model, shape, frame.input(), {.bandRows = 4});
    EXPECT_EQ(check.firstDivergent, -1) << check.nodes[std::max(0, check.firstDivergent)].node;
    const Graph whole = buildGraph(config, shape, model.lookup(), kAsWritten);
    EXPECT_GT(check.nodes.size(), whole.nodes.size());
  }
}

TEST(Session, TakesAGivenExposure) {
  const NetworkModel model = NetworkModel::random(kSmall, 3);
  const FrameShape shape{5, 7};
  Frame frame(kSmall, shape);
  Session automatic(test::gpu(), model, shape, {});
  ASSERT_TRUE(automatic.run(frame.input(), frame.output));
  Session given(test::gpu(), model, shape, {.autoExposure = false});
  FrameInput input = frame.input();
  input.exposure = automatic.exposure();
  std::vector<float> output(frame.output.size());
  ASSERT_TRUE(given.run(input, output));
  for (size_t i = 0; i < output.size(); ++i) ASSERT_NEAR(output[i], frame.output[i], 1e-4 * (1 + frame.output[i]));
}

TEST(Session, RefusesImagesOfAnotherSize) {
  const NetworkModel model = NetworkModel::random(kSmall, 3);
  Frame frame(kSmall, {5, 7});
  Session session(test::gpu(), model, {5, 8}, {});
  EXPECT_THROW(session.run(frame.input(), frame.output), Error);
}

TEST(Session, ReplaysInShortSubmissionsWhatLiesOnTheDevice) {
  const NetworkModel model = NetworkModel::random(kSmall, 3);
  const FrameShape shape{5, 7};
  Frame frame(kSmall, shape);
  Session whole(test::gpu(), model, shape, {});
  ASSERT_TRUE(whole.run(frame.input(), frame.output));

  Session pieces(test::gpu(), model, shape, {.multiplyAddsPerSubmission = 1});
  pieces.fillArena(0xffffffff);
  size_t total = 0;
  const auto count = [&](size_t, size_t all) { return total = all, true; };
  std::vector<float> output(frame.output.size());
  for (int run = 0; run < 2; ++run) {
    pieces.upload(frame.input());
    ASSERT_TRUE(pieces.replay(count));
    pieces.download(output);
    EXPECT_EQ(output, frame.output) << "run " << run;
  }
  EXPECT_GT(total, whole.graph().nodes.size() / 2);

  // The inputs may come from anywhere on the device, the output may be taken from there.
  const TensorView colour = pieces.graph().colour, result = pieces.graph().output;
  EXPECT_LE(pieces.placeOf(colour) + colour.storedByteSize(), pieces.arena().byteSize());
  std::vector<float> pixel(4);
  pieces.arena().download(pieces.placeOf(result), std::as_writable_bytes(std::span(pixel)));
  EXPECT_EQ(std::vector(pixel.begin(), pixel.begin() + 3), std::vector(output.begin(), output.begin() + 3));
}

TEST(Session, ProfilesEveryDispatch) {
  const NetworkModel model = NetworkModel::random(kSmall, 3);
  Frame frame(kSmall, {5, 7});
  Session session(test::gpu(), model, {5, 7}, {.timestamps = true});
  ASSERT_TRUE(session.run(frame.input(), frame.output));
  const auto times = session.times();
  ASSERT_GE(times.size(), session.graph().nodes.size());
  double total = 0;
  for (const DispatchTime& time : times) total += time.microseconds;
  EXPECT_GT(total, 0);
}

}  // namespace
}  // namespace xrds
