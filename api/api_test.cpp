// What callers hand to the public API: everything out of range is an Error that names it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "tests/environment_variable.h"
#include "tests/temporary_folder.h"
#include "xrds/stress.h"
#include "xrds/tuning.h"
#include "xrds/xrds.hpp"

namespace xrds {
namespace {

constexpr uint32_t kWidth = 20, kHeight = 12, kScale = 4;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

Device& device() {
  static Device device;
  return device;
}

const Model& guided() {
  static const Model model = Model::untrained(kScale, "guided");
  return model;
}

// What the Error says that the action throws; "nothing" if it throws none.
std::string messageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing";
}

void expectError(const std::function<void()>& action, const std::vector<std::string>& words) {
  const std::string message = messageOf(action);
  for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
}

void expectRefused(const Upscaler::Options& options, const std::vector<std::string>& words) {
  expectError([&] { Upscaler(device(), guided(), kWidth, kHeight, options); }, words);
  // A check takes the same options.
  const std::vector<float> pixels(size_t{3} * kScale * kScale * kWidth * kHeight, 0.5f);
  const PixelView auxiliary[] = {{pixels.data(), kScale * kWidth, kScale * kHeight},
                                 {pixels.data(), kScale * kWidth, kScale * kHeight}};
  expectError(
      [&] {
        Upscaler::check(device(), guided(), {pixels.data(), kWidth, kHeight}, auxiliary, options);
      },
      words);
}

TEST(Api, NamesAnOptionThatIsOutOfRange) {
  for (const float exposure : {kNan, 0.f, -1.f, 1e-35f, kInfinity}) expectRefused({.exposure = exposure}, {"exposure"});
  for (const float bound : {kNan, -0.1f, kInfinity}) expectRefused({.skip = {.bound = bound}}, {"skip bound"});
  for (const uint32_t passes : {0u, 3u, 16u}) expectRefused({.ensemble = passes}, {"ensemble", "1, 2, 4 or 8"});
  expectRefused({.tiles = {.columns = 1000}}, {"1000 columns"});
  expectRefused({.tiles = {.rows = ~0u}}, {"rows of tiles"});
  expectRefused({.tiles = {.halo = ~0u / 8 * 8}}, {"halo"});
  expectRefused({.multiplyAddsPerSubmission = 0}, {"multiply-adds a submission"});
}

TEST(Api, NamesWhatDoesNotFitTheFrame) {
  device();  // whose absence is no message to compare
  const auto refusal = [](const Upscaler::Options& options) {
    return messageOf([&] { Upscaler(device(), guided(), kWidth, kHeight, options); });
  };
  EXPECT_NE(refusal({.tiles = {.columns = 200}}).find("200 columns"), std::string::npos);
  EXPECT_NE(refusal({.tiles = {.rows = 3}}).find("3 rows"), std::string::npos);
  EXPECT_NE(refusal({.tiles = {.halo = 3}}).find("halo of 3"), std::string::npos);
  EXPECT_NE(refusal({.tiles = {.memoryBytes = 1}}).find("device memory"), std::string::npos);
  EXPECT_NE(refusal({.ensemble = 8, .tiles = {.wrap = true}}).find("panorama"), std::string::npos);
  EXPECT_NE(refusal({.tiles = {.wrap = true}, .skip = {.bound = 0.01f}}).find("panorama"), std::string::npos);
}

// Of an ensemble the frame and the turned one share the memory.
TEST(Api, NamesTheMemoryThatIsNeededAndAllowed) {
  for (const uint32_t ensemble : {1U, 8U}) {
    Upscaler::Options options{.ensemble = ensemble, .tiles = {.memoryBytes = 1000, .columns = 1, .rows = 1}};
    const auto refusal = [&] { return messageOf([&] { Upscaler(device(), guided(), 160, 96, options); }); };
    const std::string message = refusal();
    const size_t number = message.find("need ");
    ASSERT_NE(number, std::string::npos) << message;
    const uint64_t needed = 1'000'000 * std::stoull(message.substr(number + 5));
    options.tiles.memoryBytes = needed - 1'000'000;
    EXPECT_NE(refusal().find(" " + std::to_string(needed / 1'000'000 - 1) + " MB are allowed"), std::string::npos);
    options.tiles.memoryBytes = needed;
    EXPECT_EQ(refusal(), "nothing");
  }
}

TEST(Api, RefusesFramesOfNoOrTooLargeSize) {
  for (const auto& [width, height] :
       std::vector<std::pair<uint32_t, uint32_t>>{{0, 4}, {4, 0}, {0, 0}, {1u << 30, 1}, {~0u, ~0u}, {1, 1u << 31}}) {
    expectError([&, w = width, h = height] { Upscaler(device(), guided(), w, h, {}); },
                {std::to_string(width) + " x " + std::to_string(height), "each side"});
    expectError([&, w = width / 4 * 4, h = height / 4 * 4] { (void)guided().cost(w, h, false); }, {"each side"});
    expectError([&, w = width / 4 * 4, h = height / 4 * 4] { (void)guided().tiling(w, h, false, {}); }, {"each side"});
  }
  expectError([] { (void)guided().cost(63, 64, false); }, {"no multiple of the model's scale 4"});
  expectError([] { (void)guided().tiling(64, 64, false, {.columns = 257}); }, {"257 columns"});
  for (const auto& ask :
       {+[] { (void)guided().cost(64, 64, false, "foo"); }, +[] { (void)guided().tiling(64, 64, false, {}, "foo"); }})
    expectError(ask, {"'foo'", "plain, lane, tile, matrix or fused"});
}

/// A frame whose images may be spoilt one by one.
struct Images {
  std::vector<float> pixels = std::vector<float>(size_t{4} * kScale * kScale * kWidth * kHeight, 0.5f);
  PixelView colour{pixels.data(), kWidth, kHeight};
  std::vector<PixelView> auxiliary = std::vector<PixelView>(2, {pixels.data(), kScale* kWidth, kScale* kHeight});
  std::vector<float> output = std::vector<float>(size_t{3} * kScale * kScale * kWidth * kHeight);
  std::span<float> result{output};
};

TEST(Api, NamesAnImageThatIsNoImage) {
  Upscaler upscaler(device(), guided(), kWidth, kHeight, {});
  const auto refused = [&](const std::function<void(Images&)>& spoil, const std::vector<std::string>& words) {
    Images images;
    spoil(images);
    expectError([&] { upscaler.run(images.colour, images.auxiliary, images.result); }, words);
    if (images.result.data() != images.output.data() || images.result.size() != images.output.size()) return;
    expectError([&] { Upscaler::check(device(), guided(), images.colour, images.auxiliary, {}); }, words);
  };
  refused([](Images& i) { i.colour.pixels = nullptr; }, {"colour", "null"});
  refused([](Images& i) { i.auxiliary[1].pixels = nullptr; }, {"normal", "null"});
  for (const uint32_t stride : {0u, 1u, 2u}) {
    refused([&](Images& i) { i.colour.stride = stride; }, {"colour", "stride of " + std::to_string(stride)});
    refused([&](Images& i) { i.auxiliary[0].stride = stride; }, {"albedo", "stride of " + std::to_string(stride)});
  }
  refused([](Images& i) { i.auxiliary[0].height -= 4; }, {"albedo", "80 x 44", "80 x 48"});
  refused([](Images& i) { i.auxiliary.pop_back(); }, {"2 auxiliary images, found 1"});
  refused([](Images& i) { i.result = i.result.subspan(1); }, {"output", "room for"});
  refused([](Images& i) { i.result = {}; }, {"output", "room for 0"});
  refused([](Images& i) { i.result = {static_cast<float*>(nullptr), i.result.size()}; }, {"output", "null"});
  Images images;
  images.colour.stride = 4;  // with a channel that is not looked at
  EXPECT_TRUE(upscaler.run(images.colour, images.auxiliary, images.result));
}

TEST(Api, RefusesAStressRunOfNoModel) {
  expectError([] { Upscaler::stress(device(), {.models = {{"lost", nullptr}}}); }, {"'lost'", "null"});
}

TEST(Api, TakesDistancesOfNoPixels) { EXPECT_TRUE(relativeDepth({}).empty()); }

TEST(Api, NamesTheGridOfTilesThatAreTooLong) {
  expectError([] { Upscaler(device(), guided(), 20000, 1, {.tiles = {.columns = 1, .rows = 1}}); },
              {"20000 x 1", "65536", "more columns"});
}

// A line of 80000 pixels, longer than any graph.
TEST(Api, UpscalesALineLongerThanATileMayBe) {
  constexpr uint32_t kLength = 20000;
  for (const bool standing : {false, true}) {
    const uint32_t width = standing ? 1 : kLength, height = standing ? kLength : 1;
    const Model model = Model::untrained(kScale, "bicubic", "none");
    std::vector<float> colour(size_t{3} * kLength), output(size_t{3} * kScale * kScale * kLength, -1.f);
    for (uint32_t i = 0; i < kLength; ++i)
      for (uint32_t c = 0; c < 3; ++c) colour[3 * i + c] = 1 + 0.001f * static_cast<float>(i % 100);
    Upscaler upscaler(device(), model, width, height, {});
    EXPECT_GT(upscaler.tiling().columns * upscaler.tiling().rows, 1u);
    ASSERT_TRUE(upscaler.run({colour.data(), width, height}, {}, output));
    for (const float value : output) {
      ASSERT_GT(value, 0.98f);
      ASSERT_LT(value, 1.12f);
    }
  }
}

TEST(Api, ListsDevicesWithTheKernelsThatTheyWouldRun) {
  const std::string suitable = Device::list().front().kernelFamily;
  {
    const test::EnvironmentVariable family("XRDS_KERNEL_FAMILY", "plain");
    EXPECT_EQ(Device::list().front().kernelFamily, "plain");
  }
  const test::EnvironmentVariable family("XRDS_KERNEL_FAMILY", "foo");
  for (const auto& act : {+[] { (void)Device::list(); }, +[] { Device device; }})
    expectError(act, {"'foo'", "plain, lane, tile, matrix or fused"});
  EXPECT_EQ(Device::kernelFamilies(), (std::vector<std::string>{"plain", "lane", "tile", "matrix", "fused"}));
}

/// A device whose caches are its own.
struct FreshDevice {
  test::TemporaryFolder folder;
  Device device{{.cacheFolder = folder.path()}};
};

TEST(Api, TunesNowWhereItIsAsked) {
  FreshDevice fresh;
  constexpr uint32_t kSide = 24;  // more than Upscaler::kSmallFrame pixels
  const Model& model = guided();
  const auto known = [&] { return Tuning::known(fresh.device, model, kSide, kSide, false).has_value(); };
  EXPECT_FALSE(known());
  EXPECT_FALSE(Upscaler::paysToTune(fresh.device, model, kSide, kSide, false)) << "it has shown no pace yet";
  Upscaler untuned(fresh.device, model, kSide, kSide, {});
  EXPECT_FALSE(known()) << "a small frame is not tuned by itself";
  int told = 0;
  Upscaler::Options options{.tune = Upscaler::Tune::now, .onTuning = [&](double) { return ++told < 2; }};
  EXPECT_THROW(Upscaler(fresh.device, model, kSide, kSide, options), Cancelled);
  EXPECT_FALSE(known());
  double last = 0;
  options.onTuning = [&](double share) {
    last = std::max(last, share);
    return true;
  };
  Upscaler tuned(fresh.device, model, kSide, kSide, options);
  EXPECT_TRUE(known());
  EXPECT_GT(last, 0);
  const std::vector<float> pixels(size_t{3} * kScale * kScale * kSide * kSide, 0.5F);
  const PixelView auxiliary[] = {{pixels.data(), kScale * kSide, kScale * kSide},
                                 {pixels.data(), kScale * kSide, kScale * kSide}};
  std::vector<float> one(pixels.size()), two(pixels.size());
  untuned.run({pixels.data(), kSide, kSide}, auxiliary, one);
  tuned.run({pixels.data(), kSide, kSide}, auxiliary, two);
  for (size_t i = 0; i < one.size(); ++i) ASSERT_NEAR(one[i], two[i], 1e-5) << i;
}

// Tuning takes minutes, and would be for nothing.
TEST(Api, RefusesWhatTheMemoryCannotHoldBeforeItTunes) {
  FreshDevice fresh;
  constexpr uint32_t kSide = 24;
  bool told = false;
  Upscaler::Options options{.tune = Upscaler::Tune::now, .onTuning = [&](double) { return !(told = true); }};
  options.tiles.memoryBytes = 1000;
  expectError([&] { Upscaler(fresh.device, guided(), kSide, kSide, options); }, {"device memory", "are allowed"});
  EXPECT_FALSE(told);
}

}  // namespace
}  // namespace xrds
