#include "frames/denoised_runner.h"

#include <gtest/gtest.h>

#include <cmath>

#include "network/config.h"
#include "tests/harness.h"

namespace xrds {
namespace {

constexpr FrameShape kFrame{24, 40};
constexpr uint32_t kScale = 2;

NetworkModel denoiser() {
  return NetworkModel::random(parseConfig({{"format", "xrds"},
                                           {"version", "1"},
                                           {"architecture", "oidn"},
                                           {"scale", "1"},
                                           {"size", "small"},
                                           {"width_divisor", "8"},
                                           {"input", "hdr"},
                                           {"aux_inputs", "albedo,normal"}}),
                              1);
}

NetworkModel upscaler(bool isBroken) {
  const NetworkConfig config{
      .scale = kScale, .channels = 8, .auxChannels = 4, .groups = 1, .blocks = 1, .window = 4, .headChannels = 8};
  TensorFile file = NetworkModel::random(config, 3).file();
  if (isBroken)
    for (float& weight : file.tensors.at("out.weight").values) weight = std::copysign(3e38f, weight);
  return NetworkModel::fromTensors(std::move(file), "test");
}

// A frame, and what a runner makes of it with clean guides.
struct Denoised {
  explicit Denoised(const NetworkModel& model) {
    DenoisedRunners runners;
    runners.low = wholeRunner(test::gpu(), network, kFrame, {});
    runners.upscaler = wholeRunner(test::gpu(), model, kFrame, {.autoExposure = false});
    runners.guides = 2;
    runner.emplace(test::gpu(), std::move(runners), kFrame, kScale, model.config().auxInputs, 1.F, SessionOptions{});
  }
  std::vector<float> run() {
    std::vector<float> output(full.size());
    const PixelView aux{full.data(), kScale * kFrame.width, kScale * kFrame.height};
    EXPECT_TRUE(runner->run({{low.data(), kFrame.width, kFrame.height}, {aux, aux}}, output, {}));
    return output;
  }

  const NetworkModel network = denoiser();
  const std::vector<float> low = positive(size_t{3} * kFrame.width * kFrame.height),
                           full = positive(size_t{3} * kScale * kScale * kFrame.width * kFrame.height);
  std::optional<DenoisedRunner> runner;

 private:
  static std::vector<float> positive(size_t count) {
    auto numbers = test::randomNumbers(count, 5);
    for (float& number : numbers) number = std::abs(number);
    return numbers;
  }
};

// Where the network is not finite the base image shows, of the denoised colour.
TEST(DenoisedRunner, CountsThePixelsThatTheNetworkLost) {
  Denoised whole(upscaler(false)), broken(upscaler(true));
  whole.run();
  EXPECT_TRUE(whole.runner->lostPixels().empty());
  const std::vector<float> output = broken.run();
  EXPECT_FALSE(broken.runner->lostPixels().empty());
  for (const float number : output) ASSERT_TRUE(std::isfinite(number));
  const size_t lost = broken.runner->lostPixels().size();
  EXPECT_EQ(broken.run(), output);
  EXPECT_EQ(broken.runner->lostPixels().size(), lost);
}

// As sessions of other models do.
TEST(DenoisedRunner, GoesInTheArenaOfALargerOne) {
  const NetworkModel model = upscaler(false), network = denoiser();
  const auto larger = wholeRunner(test::gpu(), model, kFrame, {});
  const uint64_t alone = wholeRunner(test::gpu(), network, kFrame, {})->byteSize();
  const auto lent = wholeRunner(test::gpu(), network, kFrame, {.lender = larger->parts().front().session});
  EXPECT_LT(lent->byteSize(), alone);
}

// What the runner takes beside its sessions is at most what is reckoned with.
TEST(DenoisedRunner, ReckonsWithItsImages) {
  const NetworkModel model = upscaler(false);
  const Denoised made(model);
  const uint64_t sessions = wholeRunner(test::gpu(), made.network, kFrame, {})->byteSize() +
                            wholeRunner(test::gpu(), model, kFrame, {.autoExposure = false})->byteSize();
  EXPECT_GT(made.runner->byteSize(), sessions);
  EXPECT_LE(made.runner->byteSize() - sessions, DenoisedRunner::imageBytes(kFrame, kScale, model.config().auxInputs));
}

}  // namespace
}  // namespace xrds
