// The C API: the same pictures as the C++ one, in any layout of pixels, and a sentence for whatever cannot be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>

#include "engine/half.h"
#include "tests/c_api.h"
#include "tests/temporary_folder.h"

namespace xrds {
namespace {

using namespace test;

const std::string kDepthModel = XRDS_GOLDEN_FOLDER "/s4_depth.model.safetensors";

TEST_F(CApi, GivesThePictureOfTheClasses) {
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(outputPixels, expected());
  EXPECT_GT(xrdsGetExposure(upscaler), 0);
  EXPECT_GT(xrdsGetDeviceBytes(upscaler), 1000u);
}

// Planes of halves from the bottom row up, of which the colour's values are exact.
TEST_F(CApi, ReadsAndWritesAnyLayout) {
  std::vector<uint16_t> planes(3 * kWidth * kHeight), result(4 * kWide * kHigh);
  for (size_t p = 0; p < size_t{kWidth} * kHeight; ++p)
    for (size_t c = 0; c < 3; ++c) {
      const size_t y = p / kWidth, x = p % kWidth;
      planes[c * kWidth * kHeight + (kHeight - 1 - y) * kWidth + x] = toHalf(colourPixels[3 * p + c]);
      colourPixels[3 * p + c] = fromHalf(toHalf(colourPixels[3 * p + c]));
    }
  const std::vector<float> wanted = expected();
  for (size_t c = 0; c < 3; ++c) colour.channels[c] = &planes[c * kWidth * kHeight + (kHeight - 1) * kWidth];
  colour.pixelStride = 2;
  colour.rowStride = -2 * ptrdiff_t{kWidth};
  colour.format = XRDS_HALF;
  for (size_t c = 0; c < 3; ++c) output.channels[c] = &result[c * kWide * kHigh + (kHigh - 1) * kWide];
  output.pixelStride = 2;
  output.rowStride = -2 * ptrdiff_t{kWide};
  output.format = XRDS_HALF;
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  for (size_t y = 0; y < kHigh; ++y)
    for (size_t x = 0; x < kWide; ++x)
      for (size_t c = 0; c < 3; ++c)
        ASSERT_EQ(result[c * kWide * kHigh + (kHigh - 1 - y) * kWide + x], toHalf(wanted[3 * (y * kWide + x) + c]));
}

// A light in two halves, one of them as 16-bit numbers.
TEST_F(CApi, UpscalesLayersThatAddUp) {
  std::vector<float> half(colourPixels), first(outputPixels.size(), -1);
  for (float& value : half) value /= 2;
  std::vector<uint16_t> second(outputPixels.size());
  XrdsLayer layers[] = {xrdsLayerDefault(), xrdsLayerDefault()};
  for (XrdsLayer& layer : layers) layer.light = rgb(half, kWidth, kHeight);
  layers[0].output = rgb(first, kWide, kHigh);
  layers[1].output = xrdsInterleavedImage(second.data(), XRDS_HALF, 3, kWide, kHigh);
  XrdsLayerSet set = xrdsLayerSetDefault();
  set.layerCount = 2;
  set.layers = layers;
  XrdsLayerReport report{.structSize = sizeof report};
  const auto upscale = [&] {
    return xrdsUpscaleLayers(upscaler, &colour, auxiliary, 2, &output, &set, 1, &report, nullptr, nullptr);
  };
  ASSERT_EQ(upscale(), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(outputPixels, expected());
  EXPECT_NEAR(report.share, 1, 1e-6);
  for (size_t i = 0; i < outputPixels.size(); ++i) {
    ASSERT_NEAR(first[i], outputPixels[i] / 2, 1e-6 * outputPixels[i]);
    ASSERT_EQ(second[i], toHalf(first[i]));
  }
  layers[1].structSize = 8;
  EXPECT_EQ(upscale(), XRDS_ERROR_ARGUMENT);
  layers[1].structSize = sizeof layers[1];
  std::swap(layers[0].output.width, layers[0].output.height);
  EXPECT_EQ(upscale(), XRDS_ERROR_ARGUMENT);
  std::swap(layers[0].output.width, layers[0].output.height);
  layers[1].colour = 0;
  EXPECT_EQ(upscale(), XRDS_ERROR_ARGUMENT);
  layers[1].colour = -1;
  report.structSize = 1;
  EXPECT_EQ(upscale(), XRDS_ERROR_ARGUMENT);
  set.layers = nullptr;
  EXPECT_EQ(upscale(), XRDS_ERROR_ARGUMENT);
}

TEST_F(CApi, UpscalesAlphaAndKeepsOpaqueOpaque) {
  std::vector<float> rgba(4 * kWidth * kHeight, 1), result(4 * kWide * kHigh, -1);
  for (size_t p = 0; p < size_t{kWidth} * kHeight; ++p) {
    std::copy_n(&colourPixels[3 * p], 3, &rgba[4 * p]);
    rgba[4 * p + 3] = p % kWidth < kWidth / 2 ? 0.F : 1.F;
  }
  colour = xrdsInterleavedImage(rgba.data(), XRDS_FLOAT, 4, kWidth, kHeight);
  output = xrdsInterleavedImage(result.data(), XRDS_FLOAT, 4, kWide, kHigh);
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  const std::vector<float> wanted = expected();
  for (size_t p = 0; p < size_t{kWide} * kHigh; ++p) EXPECT_EQ(result[4 * p], wanted[3 * p]);
  EXPECT_EQ(result[3], 0);
  EXPECT_EQ(result[4 * kWide - 1], 1);
  EXPECT_NEAR(result[4 * (kWide / 2) + 3], 0.5F, 0.2F);
  colour = rgb(colourPixels, kWidth, kHeight);  // without alpha all is opaque
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(result[3], 1);
}

TEST_F(CApi, TakesDistancesForTheDepth) {
  XrdsModel* deepModel = nullptr;
  XrdsUpscaler* deep = nullptr;
  ASSERT_EQ(xrdsOpenModel(kDepthModel.c_str(), &deepModel), XRDS_OK);
  ASSERT_EQ(xrdsCountModelInputs(deepModel), 3u);
  EXPECT_STREQ(xrdsGetModelInput(deepModel, 2), "depth");
  EXPECT_EQ(xrdsGetModelInput(deepModel, 3), nullptr);
  ASSERT_EQ(xrdsCreateUpscaler(device, deepModel, kWidth, kHeight, nullptr, &deep), XRDS_OK);
  std::vector<float> distances = noise(kWide * kHigh, 4), relative = relativeDepth(distances);
  XrdsImage images[] = {auxiliary[0], auxiliary[1],
                        xrdsInterleavedImage(distances.data(), XRDS_FLOAT, 1, kWide, kHigh)};
  ASSERT_EQ(xrdsUpscale(deep, &colour, images, 3, &output, nullptr, nullptr), XRDS_OK) << xrdsGetMessage();
  const std::vector<float> first = outputPixels;
  images[2] = rgb(relative, kWide, kHigh);
  ASSERT_EQ(xrdsUpscale(deep, &colour, images, 3, &output, nullptr, nullptr), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(outputPixels, first);
  xrdsDestroyUpscaler(deep);
  xrdsCloseModel(deepModel);
}

TEST_F(CApi, IsFiniteWhateverTheInputs) {
  colourPixels[5] = std::numeric_limits<float>::quiet_NaN();
  albedo[7] = std::numeric_limits<float>::infinity();
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  for (const float value : outputPixels) ASSERT_TRUE(std::isfinite(value));
}

TEST_F(CApi, RefusesWhatCannotBe) {
  const auto refused = [&](XrdsResult result, const char* words) {
    EXPECT_EQ(result, XRDS_ERROR_ARGUMENT);
    EXPECT_NE(std::string(xrdsGetMessage()).find(words), std::string::npos) << words << " in " << xrdsGetMessage();
  };
  const auto upscale = [&](const XrdsImage* colour, const XrdsImage* auxiliary, uint32_t count,
                           const XrdsImage* output) {
    return xrdsUpscale(upscaler, colour, auxiliary, count, output, nullptr, nullptr);
  };
  refused(upscale(nullptr, auxiliary, 2, &output), "'colour' is a null pointer");
  refused(upscale(&colour, nullptr, 2, &output), "'auxiliary' is a null pointer");
  refused(upscale(&colour, auxiliary, 1, &output), "takes 2 auxiliary images, found 1");
  refused(upscale(&colour, auxiliary, 2, nullptr), "'output' is a null pointer");
  refused(upscale(&output, auxiliary, 2, &output), "The colour image is 56 x 36 pixels, expected 14 x 9");
  refused(upscale(&colour, auxiliary, 2, &colour), "The output image is 14 x 9 pixels, expected 56 x 36");
  XrdsImage without = colour;
  without.channels[1] = nullptr;
  refused(upscale(&without, auxiliary, 2, &output), "The colour image has no channel 1");
  for (const uint32_t height : {1U, 9U}) {
    const XrdsImage absurd = xrdsInterleavedImage(colourPixels.data(), XRDS_FLOAT, ~0U, ~0U, height);
    EXPECT_GT(absurd.rowStride, 0);
    refused(upscale(&absurd, auxiliary, 2, &output), "The colour image is 4294967295 x");
  }
  XrdsImage strange = colour;
  strange.format = static_cast<XrdsFormat>(7);
  refused(upscale(&strange, auxiliary, 2, &output), "expected XRDS_FLOAT or XRDS_HALF");

  XrdsUpscaler* made = nullptr;
  refused(xrdsCreateUpscaler(device, model, 0, 5, nullptr, &made), "0 x 5 pixels");
  refused(xrdsCreateUpscaler(nullptr, model, 5, 5, nullptr, &made), "The device is a null pointer");
  refused(xrdsCreateUpscaler(device, model, 5, 5, nullptr, nullptr), "'upscaler' is a null pointer");
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.ensemble = 3;
  refused(xrdsCreateUpscaler(device, model, 5, 5, &options, &made), "expected 1, 2, 4 or 8");
  options = xrdsUpscalerOptionsDefault();
  options.exposure = -1;
  refused(xrdsCreateUpscaler(device, model, 5, 5, &options, &made), "exposure");
  options = xrdsUpscalerOptionsDefault();
  options.tune = static_cast<XrdsTune>(3);
  refused(xrdsCreateUpscaler(device, model, 5, 5, &options, &made), "expected XRDS_TUNE_AUTO");
  options = xrdsUpscalerOptionsDefault();
  options.denoiser = reinterpret_cast<const XrdsModel*>(&options);
  refused(xrdsCreateUpscaler(device, model, 5, 5, &options, &made), "The denoiser is not open");
  const XrdsHearCheck hear = [](void*, const XrdsCheckRow*) {};
  refused(xrdsCheckFrame(device, model, &colour, auxiliary, 2, &options, hear, nullptr), "The denoiser is not open");
  options.structSize = 4;
  refused(xrdsCreateUpscaler(device, model, 5, 5, &options, &made), "XrdsUpscalerOptions has a structSize of 4");
  EXPECT_EQ(made, nullptr);
  XrdsDeviceOptions family = xrdsDeviceOptionsDefault();
  family.kernelFamily = "none";
  XrdsDevice* opened = nullptr;
  refused(xrdsOpenDevice(&family, &opened), "no kernel family 'none'");
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();  // nothing of it did any harm
}

TEST_F(CApi, RefusesHandlesThatAreNotOpen) {
  XrdsDevice* const closed = device;
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  xrdsCloseDevice(device);
  xrdsCloseModel(model);
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();  // which keeps both alive
  XrdsUpscaler* made = nullptr;
  EXPECT_EQ(xrdsCreateUpscaler(closed, model, 5, 5, nullptr, &made), XRDS_ERROR_ARGUMENT);
  EXPECT_STREQ(xrdsGetMessage(), "The device is not open: it was closed, or is no handle at all.");
  EXPECT_EQ(xrdsGetModelScale(model), 0u);
  xrdsCloseDevice(closed);
  xrdsDestroyUpscaler(upscaler);
  EXPECT_EQ(run(), XRDS_ERROR_ARGUMENT);
  EXPECT_EQ(xrdsGetDeviceBytes(upscaler), 0u);
}

TEST_F(CApi, ToldToTakeTooLittleMemoryItIsOutOfIt) {
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.memoryBytes = 1;
  XrdsUpscaler* made = nullptr;
  EXPECT_EQ(xrdsCreateUpscaler(device, model, kWidth, kHeight, &options, &made), XRDS_ERROR_OUT_OF_MEMORY);
  EXPECT_NE(std::string(xrdsGetMessage()).find("MB are allowed: allow more"), std::string::npos) << xrdsGetMessage();
  auto tiling = call::sized<XrdsTiling>();
  EXPECT_EQ(xrdsPlanTiles(model, kWide, kHigh, &options, "plain", &tiling), XRDS_ERROR_OUT_OF_MEMORY);
}

TEST_F(CApi, CancelsAndSaysWhenItIsBusy) {
  const auto cancel = [](void* user, double share) {
    EXPECT_TRUE(share >= 0 && share <= 1);
    ++*static_cast<int*>(user);
    return 0;
  };
  int heard = 0;
  EXPECT_EQ(run(cancel, &heard), XRDS_CANCELLED);
  EXPECT_EQ(heard, 1);
  const auto meanwhile = [](void* user, double) {
    auto& test = *static_cast<CApi*>(user);
    std::thread([&] {
      EXPECT_EQ(test.run(), XRDS_ERROR_BUSY);
      EXPECT_NE(std::string(xrdsGetMessage()).find("another thread"), std::string::npos);
    }).join();
    return 1;
  };
  EXPECT_EQ(run(meanwhile, this), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(outputPixels, expected());
}

TEST_F(CApi, TellsWhatItKnowsWhileItRuns) {
  struct Known {
    const XrdsUpscaler* upscaler;
    std::vector<float> exposures;
    std::vector<uint64_t> bytes;
  } known{upscaler};
  const auto ask = [](void* user, double) {
    auto& asked = *static_cast<Known*>(user);
    asked.exposures.push_back(xrdsGetExposure(asked.upscaler));
    asked.bytes.push_back(xrdsGetDeviceBytes(asked.upscaler));
    return 1;
  };
  ASSERT_EQ(run(ask, &known), XRDS_OK) << xrdsGetMessage();
  ASSERT_FALSE(known.bytes.empty());
  EXPECT_EQ(known.exposures.front(), 0);  // no run has ended
  EXPECT_EQ(known.bytes.front(), xrdsGetDeviceBytes(upscaler));
  const float first = xrdsGetExposure(upscaler);
  for (float& number : colourPixels) number *= 2;
  known = {upscaler, {}, {}};
  ASSERT_EQ(run(ask, &known), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(known.exposures.front(), first);
  EXPECT_NE(xrdsGetExposure(upscaler), first);
}

TEST_F(CApi, ThreadsWithAnUpscalerEachShareADevice) {
  const std::vector<float> wanted = expected();
  std::vector<std::thread> threads;
  threads.reserve(3);
  for (int i = 0; i < 3; ++i)
    threads.emplace_back([&] {
      XrdsUpscaler* own = nullptr;
      ASSERT_EQ(xrdsCreateUpscaler(device, model, kWidth, kHeight, nullptr, &own), XRDS_OK) << xrdsGetMessage();
      std::vector<float> pixels(wanted.size());
      const XrdsImage picture = rgb(pixels, kWide, kHigh);
      for (int frame = 0; frame < 3; ++frame)
        EXPECT_EQ(xrdsUpscale(own, &colour, auxiliary, 2, &picture, nullptr, nullptr), XRDS_OK);
      EXPECT_EQ(pixels, wanted);
      xrdsDestroyUpscaler(own);
    });
  for (std::thread& thread : threads) thread.join();
}

TEST(CApiDevices, AreDescribed) {
  uint32_t count = 0;
  ASSERT_EQ(xrdsCountDevices(&count), XRDS_OK) << xrdsGetMessage();
  ASSERT_GT(count, 0u);
  XrdsDeviceDescription found{};
  EXPECT_EQ(xrdsDescribeDevice(0, &found), XRDS_ERROR_ARGUMENT);  // structSize
  found.structSize = sizeof found;
  ASSERT_EQ(xrdsDescribeDevice(0, &found), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(found.name, Device::list()[0].name);
  EXPECT_EQ(std::string(found.uuid).size(), 32u);
  EXPECT_EQ(xrdsDescribeDevice(count, &found), XRDS_ERROR_ARGUMENT);
  XrdsDeviceOptions options = xrdsDeviceOptionsDefault();
  options.select = "no such device";
  XrdsDevice* device = nullptr;
  EXPECT_EQ(xrdsOpenDevice(&options, &device), XRDS_ERROR_FAILED);
  EXPECT_NE(std::string(xrdsGetMessage()).find(found.name), std::string::npos) << xrdsGetMessage();
  EXPECT_EQ(device, nullptr);
  ASSERT_EQ(xrdsOpenDevice(nullptr, &device), XRDS_OK) << xrdsGetMessage();
  XrdsDeviceDescription open{.structSize = sizeof open};
  ASSERT_EQ(xrdsDescribeOpenDevice(device, &open), XRDS_OK) << xrdsGetMessage();
  EXPECT_STREQ(open.uuid, Device().description().uuid.c_str());
  open.structSize = 1;
  EXPECT_EQ(xrdsDescribeOpenDevice(device, &open), XRDS_ERROR_ARGUMENT);
  xrdsCloseDevice(device);
  open.structSize = sizeof open;
  EXPECT_EQ(xrdsDescribeOpenDevice(device, &open), XRDS_ERROR_ARGUMENT);
}

// Minutes on a CPU, which nobody must have to wait for.
TEST(CApiDevices, CancelATuning) {
  const test::TemporaryFolder cache;
  const std::string folder = cache.path().string();
  int heard = 0;
  XrdsDeviceOptions options = xrdsDeviceOptionsDefault();
  options.cacheFolder = folder.c_str();
  options.preparationUser = &heard;
  options.preparation = [](void* user, int machineCode, size_t done, size_t total) {
    EXPECT_LE(done, total);
    *static_cast<int*>(user) += machineCode == 2;
    return static_cast<int>(machineCode != 2);
  };
  XrdsDevice* device = nullptr;
  XrdsModel* model = nullptr;
  XrdsUpscaler* upscaler = nullptr;
  ASSERT_EQ(xrdsOpenDevice(&options, &device), XRDS_OK) << xrdsGetMessage();
  ASSERT_EQ(xrdsOpenModel(kModel.c_str(), &model), XRDS_OK) << xrdsGetMessage();
  XrdsUpscalerOptions tuned = xrdsUpscalerOptionsDefault();
  tuned.tune = XRDS_TUNE_NOW;
  EXPECT_EQ(xrdsCreateUpscaler(device, model, 24, 24, &tuned, &upscaler), XRDS_CANCELLED);
  EXPECT_EQ(heard, 1);
  EXPECT_EQ(upscaler, nullptr);
  xrdsCloseModel(model);
  xrdsCloseDevice(device);
}

TEST(CApiColours, AreMerged) {
  std::vector<float> low = noise(4 * kWidth * kHeight, 5), full = noise(3 * kWide * kHigh, 6), merged(low.size());
  const XrdsImage from = xrdsInterleavedImage(low.data(), XRDS_FLOAT, 4, kWidth, kHeight),
                  with = rgb(full, kWide, kHigh);
  const XrdsImage to = xrdsInterleavedImage(merged.data(), XRDS_FLOAT, 4, kWidth, kHeight);
  ASSERT_EQ(xrdsMergeColour(&from, &with, 64, 16, &to), XRDS_OK) << xrdsGetMessage();
  const auto wanted =
      mergedColour({low.data(), kWidth, kHeight, 4}, {full.data(), kWide, kHigh}, fullShare({64, 16}, 4));
  for (size_t p = 0; p < size_t{kWidth} * kHeight; ++p) {
    EXPECT_EQ(merged[4 * p], wanted[3 * p]);
    EXPECT_EQ(merged[4 * p + 3], low[4 * p + 3]);
  }
  EXPECT_EQ(xrdsMergeColour(&with, &from, 64, 16, &with), XRDS_ERROR_ARGUMENT);
  EXPECT_EQ(xrdsMergeColour(&from, &with, 64, 0, &to), XRDS_ERROR_ARGUMENT);
  for (const double share : {-0.1, 1.1, std::nan("")})
    EXPECT_EQ(xrdsMergeByShare(&from, &with, share, &to), XRDS_ERROR_ARGUMENT) << share;
  double difference = -1;
  ASSERT_EQ(xrdsCompareColour(&from, &with, &difference), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(difference, colourDifference({low.data(), kWidth, kHeight, 4}, {full.data(), kWide, kHigh}));
  EXPECT_EQ(xrdsCompareColour(&with, &from, &difference), XRDS_ERROR_ARGUMENT);
  EXPECT_EQ(xrdsCompareColour(&from, &with, nullptr), XRDS_ERROR_ARGUMENT);
}

TEST(CApiVersion, IsThatOfTheProject) {
  uint32_t major = 9, minor = 9;
  xrdsGetVersion(&major, &minor, nullptr);
  EXPECT_EQ(std::to_string(major) + "." + std::to_string(minor), std::string(XRDS_VERSION).substr(0, 3));
}

}  // namespace
}  // namespace xrds
