// What is left out of a frame changes it by no more than is promised, and nothing else of it.
#include "frames/sparse_runner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "network/halo.h"
#include "tests/harness.h"
#include "xrds/error.h"

namespace xrds {
namespace {

const NetworkConfig kConfig{
    .scale = 2, .channels = 8, .auxChannels = 4, .groups = 1, .blocks = 1, .window = 4, .headChannels = 8};
const FrameShape kFrame{58, 93};  // the last windows are cut
constexpr float kBound = 0.005f;

/// An even background, and noise in a rectangle of the low-resolution pixels.
struct Frame {
  explicit Frame(const Rectangle& noise) {
    const auto paint = [&](std::vector<float>& image, uint32_t s, uint32_t seed, float even) {
      image.assign(3 * size_t{kFrame.width} * kFrame.height * s * s, even);
      const std::vector<float> random = test::randomNumbers(image.size(), seed);
      for (uint32_t y = noise.y * s; y < (noise.y + noise.height) * s; ++y)
        for (size_t i = size_t{3} * noise.x * s; i < size_t{3} * (noise.x + noise.width) * s; ++i) {
          const size_t at = size_t{3} * y * kFrame.width * s + i;
          image[at] = std::abs(random[at]);
        }
    };
    paint(colour, 1, 1, 0.4f);
    paint(albedo, kConfig.scale, 2, 0.5f);
    paint(normal, kConfig.scale, 3, 0.f);
  }
  FrameInput input(std::optional<float> exposure = 1.f) const {
    const uint32_t width = kConfig.scale * kFrame.width, height = kConfig.scale * kFrame.height;
    return {{colour.data(), kFrame.width, kFrame.height},
            {{albedo.data(), width, height}, {normal.data(), width, height}},
            exposure};
  }
  std::vector<float> run(SparseRunner& runner, std::optional<float> exposure = 1.f) const {
    std::vector<float> output(albedo.size(), NAN);
    EXPECT_TRUE(runner.run(input(exposure), output));
    return output;
  }
  std::vector<float> runWhole(const NetworkModel& model, std::optional<float> exposure = 1.f) const {
    Session session(test::gpu(), model, kFrame, {.autoExposure = !exposure});
    std::vector<float> output(albedo.size());
    session.run(input(exposure), output);
    return output;
  }
  std::vector<float> colour, albedo, normal;
};

SparseRunner runnerOf(const NetworkModel& model, const SparseOptions& options) {
  const Rectangle whole{0, 0, kFrame.width, kFrame.height};
  return {test::gpu(), model, {}, {{whole, whole}}, options};
}

// The network of this model changes nothing: its result is the base image.
NetworkModel withoutResidual() {
  TensorFile file = NetworkModel::random(kConfig, 3).file();
  for (const char* name : {"out.weight", "out.bias"})
    file.tensors.at(name).values.assign(file.tensors.at(name).values.size(), 0.f);
  return NetworkModel::fromTensors(std::move(file), "test");
}

// The largest root mean square change of a window.
double largestChange(const std::vector<float>& a, const std::vector<float>& b) {
  const uint32_t side = kConfig.window * kConfig.scale, width = kConfig.scale * kFrame.width;
  const WindowMask windows(kFrame, kConfig.window, false);
  std::vector<double> sums(windows.marks.size()), counts(windows.marks.size());
  for (size_t i = 0; i < a.size(); ++i) {
    const size_t window = i / 3 / width / side * windows.columns + i / 3 % width / side;
    sums[window] += std::pow(std::log1p(std::max(a[i], 0.f)) - std::log1p(std::max(b[i], 0.f)), 2);
    ++counts[window];
  }
  double largest = 0;
  for (size_t w = 0; w < sums.size(); ++w) largest = std::max(largest, std::sqrt(sums[w] / counts[w]));
  return largest;
}

TEST(SparseRunner, GivesTheWholeFrameBitForBitWhereNothingIsQuiet) {
  const NetworkModel model = NetworkModel::random(kConfig, 3);
  const Frame frame({0, 0, kFrame.width, kFrame.height});
  for (const std::optional<float> exposure : {std::optional<float>(), std::optional(1.f)}) {
    SparseRunner runner = runnerOf(model, {.bound = kBound, .keepUnchanged = true, .reach = 8, .halo = 8});
    EXPECT_EQ(frame.run(runner, exposure), frame.runWhole(model, exposure));
    EXPECT_EQ(runner.interpolated().count() + runner.kept().count(), 0U);
    EXPECT_EQ(runner.work(), 1);
  }
}

TEST(SparseRunner, InterpolatesTheBackgroundWithinItsBoundAndWithoutSeam) {
  const NetworkModel model = withoutResidual();
  const Frame frame({20, 16, 25, 19});
  SparseRunner runner = runnerOf(model, {.bound = kBound, .halo = 4});
  const std::vector<float> result = frame.run(runner);
  EXPECT_LE(largestChange(result, frame.runWhole(model)), 0.1 * kBound);
  EXPECT_GT(runner.interpolated().count(), runner.interpolated().marks.size() / 2);
  EXPECT_LT(runner.work(), 0.4);
}

TEST(SparseRunner, ComputesTheRestExactlyWithTheExactHalo) {
  const NetworkModel model = NetworkModel::random(kConfig, 3);
  const Frame frame({0, 0, 30, kFrame.height});
  SparseRunner runner = runnerOf(model, {.bound = kBound, .halo = exactHalo(kConfig)});
  const std::vector<float> result = frame.run(runner), whole = frame.runWhole(model);
  ASSERT_LT(runner.work(), 1);
  const uint32_t side = kConfig.window * kConfig.scale, width = kConfig.scale * kFrame.width;
  for (size_t i = 0; i < result.size(); ++i) {
    const auto y = static_cast<uint32_t>(i / 3 / width), x = static_cast<uint32_t>(i / 3 % width);
    if (!runner.interpolated().at(y / side, x / side)) {
      ASSERT_EQ(result[i], whole[i]) << x << " " << y;
    }
  }
}

TEST(SparseRunner, InterpolatesAnEmptyFrameWithoutTheNetwork) {
  SparseRunner runner = runnerOf(NetworkModel::random(kConfig, 3), {.bound = kBound});
  for (const float value : Frame({}).run(runner, std::nullopt)) ASSERT_NEAR(value, 0.4f, 1e-6f);
  EXPECT_EQ(runner.work(), 0);
  EXPECT_NEAR(runner.exposure(), 0.18 / 0.4, 1e-5);
}

TEST(SparseRunner, KeepsWhatDidNotChangeBitForBit) {
  const NetworkModel model = NetworkModel::random(kConfig, 3);
  const uint32_t halo = exactHalo(kConfig);
  SparseRunner runner = runnerOf(model, {.keepUnchanged = true, .reach = halo, .halo = halo});
  Frame frame({0, 0, kFrame.width, kFrame.height});
  EXPECT_EQ(frame.run(runner), frame.runWhole(model));
  EXPECT_EQ(frame.run(runner), frame.runWhole(model));
  EXPECT_EQ(runner.work(), 0);
  frame.albedo[7] += 0.25f;
  EXPECT_EQ(frame.run(runner), frame.runWhole(model));
  EXPECT_LT(runner.work(), 0.6);
  EXPECT_GT(runner.kept().count(), runner.kept().marks.size() / 2);
  frame.colour.back() += 0.25f;
  EXPECT_EQ(frame.run(runner), frame.runWhole(model));
  EXPECT_LT(runner.work(), 0.6);
  EXPECT_EQ(frame.run(runner, 1.1f), frame.runWhole(model, 1.1f));
  EXPECT_EQ(runner.work(), 1);
}

// Where the network is not finite the base image shows, also in windows that are kept.
TEST(SparseRunner, CountsThePixelsThatWereLostInKeptWindowsToo) {
  TensorFile file = NetworkModel::random(kConfig, 3).file();
  for (float& weight : file.tensors.at("out.weight").values) weight = std::copysign(3e38f, weight);
  const NetworkModel model = NetworkModel::fromTensors(std::move(file), "test");
  Frame frame({0, 0, kFrame.width, kFrame.height});
  Session whole(test::gpu(), model, kFrame, {.autoExposure = false});
  std::vector<float> output(frame.albedo.size());
  whole.run(frame.input(), output);
  const std::vector<uint64_t> lost = whole.lostPixels();
  ASSERT_GT(lost.size(), 0U);

  const uint32_t halo = exactHalo(kConfig);
  SparseRunner runner = runnerOf(model, {.keepUnchanged = true, .reach = halo, .halo = halo});
  for (int run = 0; run < 3; ++run) {
    EXPECT_EQ(frame.run(runner), output) << run;
    EXPECT_EQ(runner.lostPixels(), lost) << run;
  }
  EXPECT_EQ(runner.work(), 0);
  frame.colour.back() += 0.25f;
  EXPECT_EQ(frame.run(runner), frame.runWhole(model));
  EXPECT_GT(runner.kept().count(), 0U);
  whole.run(frame.input(), output);
  std::vector<uint64_t> found = runner.lostPixels();
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, whole.lostPixels());
}

TEST(SparseRunner, HoldsAnExposureOfItsOwn) {
  const NetworkModel model = NetworkModel::random(kConfig, 3);
  SparseRunner runner = runnerOf(model, {.keepUnchanged = true, .reach = 4, .halo = 4});
  Frame frame({0, 0, kFrame.width, kFrame.height});
  frame.run(runner, std::nullopt);
  const float first = runner.exposure();
  frame.colour[0] += 0.3f;
  frame.run(runner, std::nullopt);
  EXPECT_EQ(runner.exposure(), first);
  EXPECT_GT(runner.kept().count(), 0U);
  for (float& value : frame.colour) value *= 1.5f;
  frame.run(runner, std::nullopt);
  EXPECT_NEAR(runner.exposure(), first / 1.5f, 0.01 * first);
  EXPECT_EQ(runner.kept().count(), 0U);
}

TEST(SparseRunner, ACancelledRunForgetsNothing) {
  const NetworkModel model = NetworkModel::random(kConfig, 3);
  SparseRunner runner = runnerOf(model, {.keepUnchanged = true, .reach = 8, .halo = 8});
  Frame frame({0, 0, kFrame.width, kFrame.height});
  const std::vector<float> before = frame.run(runner);
  Frame other = frame;
  for (float& value : other.colour) value *= 0.5f;
  std::vector<float> output(before.size());
  const auto stop = [](double) { return false; };
  EXPECT_FALSE(runner.run(other.input(), output, stop));
  EXPECT_EQ(frame.run(runner), before);
  EXPECT_EQ(runner.work(), 0);
}

TEST(SparseRunner, RefusesABoundThatCannotHold) {
  NetworkConfig config = kConfig;
  config.base = BaseImage::none;
  EXPECT_THROW(runnerOf(NetworkModel::random(config, 3), {.bound = kBound}), Error);
  runnerOf(NetworkModel::random(config, 3), {.keepUnchanged = true});
}

}  // namespace
}  // namespace xrds
