// The denoisers' U-Nets on the device against forward passes of training/unet.py in double precision.
#include <gtest/gtest.h>

#include <cmath>

#include "frames/frame_exposure.h"
#include "frames/session.h"
#include "frames/tile_runner.h"
#include "network/halo.h"
#include "network/oidn.h"
#include "tests/harness.h"

namespace xrds {
namespace {

using test::relativeRms;

const std::filesystem::path kFolder = std::filesystem::path(XRDS_GOLDEN_FOLDER) / "unet";
constexpr const char* kNames[] = {
    "hdr_small",    "hdr_albedo_base", "hdr_albedo_normal_large", "ldr_albedo_normal_small",
    "albedo_small", "normal_small"};

/// A golden model with the images that it was given and what PyTorch made of them.
struct Golden {
  explicit Golden(const std::string& name)
      : model(NetworkModel::read(kFolder / (name + ".model.safetensors"))),
        tensors(readTensors(kFolder / (name + ".io.safetensors"))) {
    const auto& colour = tensors.tensors.at("colour");
    frame = {static_cast<uint32_t>(colour.shape[0]), static_cast<uint32_t>(colour.shape[1])};
    input.colour = viewOf("colour");
    for (const std::string& guide : model.config().auxInputs) input.auxiliary.push_back(viewOf(guide));
    if (takesBinnedExposure(model.config())) input.exposure = binnedExposure(input.colour);
  }
  PixelView viewOf(const std::string& name) const {
    return {tensors.tensors.at(name).values.data(), frame.width, frame.height};
  }
  const std::vector<float>& output() const { return tensors.tensors.at("output").values; }

  NetworkModel model;
  TensorFile tensors;
  FrameShape frame;
  FrameInput input;
};

std::vector<float> outputOf(const NetworkModel& model, FrameShape frame, const FrameInput& input, KernelFamily family,
                            const SessionOptions& options) {
  Gpu& gpu = test::gpu();
  const DeviceTraits traits = gpu.traits();
  gpu.setTraits(test::traitsOf(family));
  Session session(gpu, model, frame, options);
  gpu.setTraits(traits);
  session.fillArena(0x7fc00000);  // NaN
  std::vector<float> output(size_t{3} * frame.height * frame.width);
  EXPECT_TRUE(session.run(input, output));
  return output;
}

std::vector<float> outputOf(const Golden& golden, KernelFamily family, const SessionOptions& options) {
  return outputOf(golden.model, golden.frame, golden.input, family, options);
}

class GoldenUNet : public testing::TestWithParam<const char*> {};

TEST_P(GoldenUNet, MatchesPyTorch) {
  const Golden golden(GetParam());
  const KernelFamily own = test::gpu().traits().family;
  if (golden.input.exposure) {
    EXPECT_NEAR(golden.input.exposure->value / golden.tensors.tensors.at("exposure").values[0], 1, 1e-6);
  }
  EXPECT_LT(relativeRms(outputOf(golden, own, {}), golden.output()), 1e-4);
  EXPECT_LT(relativeRms(outputOf(golden, KernelFamily::plain, {}), golden.output()), 1e-4);
  EXPECT_LT(relativeRms(outputOf(golden, own, {.precision = Precision::fp16}), golden.output()), 5e-3);
}

INSTANTIATE_TEST_SUITE_P(All, GoldenUNet, testing::ValuesIn(kNames), [](const auto& info) { return info.param; });

// In sweeps over bands of rows, and with every value in bytes of its own.
TEST(UNet, BandsAndPlansGiveTheSame) {
  const Golden golden("hdr_albedo_normal_large");
  const KernelFamily own = test::gpu().traits().family;
  const std::vector<float> whole = outputOf(golden, own, {.bandRows = kWholeFrame});
  EXPECT_EQ(outputOf(golden, own, {.bandRows = 16}), whole);
  EXPECT_EQ(outputOf(golden, own, {.bandRows = 16, .aliasing = false}), whole);
}

// Of the published widths, whose convolutions CPU devices make in squares, with the way down and up in them.
TEST(UNet, OfPublishedWidthIsTheSameInSquares) {
  const NetworkModel model = NetworkModel::random(parseConfig({{"format", "xrds"},
                                                               {"version", "1"},
                                                               {"architecture", "oidn"},
                                                               {"scale", "1"},
                                                               {"size", "base"},
                                                               {"input", "hdr"},
                                                               {"aux_inputs", "albedo,normal"}}),
                                                  1);
  const FrameShape frame{45, 76};
  const std::vector<float> pixels = test::randomNumbers(size_t{3} * frame.height * frame.width, 7);
  const PixelView view{pixels.data(), frame.width, frame.height};
  FrameInput input{view, {view, view}};
  input.exposure = binnedExposure(view);
  const auto made = [&](KernelFamily family, const SessionOptions& options) {
    return outputOf(model, frame, input, family, options);
  };
  const std::vector<float> plain = made(KernelFamily::plain, {});
  const std::vector<float> lane = made(KernelFamily::lane, {.bandRows = kWholeFrame});
  EXPECT_LT(relativeRms(lane, plain), 1e-5);
  EXPECT_EQ(made(KernelFamily::lane, {.bandRows = 16}), lane);
  EXPECT_EQ(made(KernelFamily::lane, {.bandRows = 16, .aliasing = false}), lane);
}

// A U-Net sees far: the crops of this frame are nearly all of it.
// Of frames whose coarsest level has an even and an odd number of columns in the original.
TEST(UNet, TilesWithTheExactHaloGiveTheFrame) {
  const Golden golden("hdr_small");
  const uint32_t halo = exactHalo(golden.model.config());
  EXPECT_EQ(halo % golden.model.config().window, 0u);
  for (const uint32_t rest : {90u, 70u})
    for (const Precision precision : {Precision::fp32, Precision::fp16}) {
      const FrameShape shape{37, 2 * halo + rest};
      std::vector<float> pixels(size_t{3} * shape.width * shape.height);
      for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<float>(i * 7919 % 1009) / 300;
      FrameInput input{{pixels.data(), shape.width, shape.height}};
      input.exposure = binnedExposure(input.colour);
      std::vector<float> whole(pixels.size()), tiled(pixels.size());
      Session session(test::gpu(), golden.model, shape, {.precision = precision});
      ASSERT_TRUE(session.run(input, whole));
      TileRunner tiles(test::gpu(), golden.model, {.precision = precision});
      const auto cut = cutFrame(shape, golden.model.config().window, {3, 1, halo});
      EXPECT_EQ(cut.size(), 3u);
      ASSERT_TRUE(tiles.run(input, cut, tiled));
      EXPECT_EQ(tiled, whole) << rest << ", " << nameOf(precision);
    }
}

}  // namespace
}  // namespace xrds
