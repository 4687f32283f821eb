// Denoisers in front of an upscaler in C, one after the other: what its functions give image by image.
#include <algorithm>

#include "tests/c_api.h"
#include "xrds/denoised_first.h"
#include "xrds/xrds_report.h"

namespace xrds {
namespace {

using namespace test;

class CApiDenoising : public CApi {
 public:
  using Pixels = std::vector<float>;

  void SetUp() override {
    CApi::SetUp();
    const char* const names[] = {"hdr_albedo_normal_large", "albedo_small", "normal_small"};
    for (int i = 0; i < 3; ++i) {
      const std::string file = std::string(XRDS_GOLDEN_FOLDER) + "/unet/" + names[i] + ".model.safetensors";
      ASSERT_EQ(xrdsOpenModel(file.c_str(), &networks[i]), XRDS_OK) << xrdsGetMessage();
    }
  }
  void TearDown() override {
    for (XrdsModel* network : networks) xrdsCloseModel(network);
    CApi::TearDown();
  }

  XrdsUpscaler* create(const XrdsModel* of, uint32_t width, uint32_t height, const XrdsUpscalerOptions& options) {
    XrdsUpscaler* made = nullptr;
    EXPECT_EQ(xrdsCreateUpscaler(device, of, width, height, &options, &made), XRDS_OK) << xrdsGetMessage();
    return made;
  }

  // An image through a network of the denoiser.
  Pixels through(const XrdsModel* network, const PixelView& image, std::span<const PixelView> guides) {
    XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
    options.exactTiles = 1;
    XrdsUpscaler* made = create(network, image.width, image.height, options);
    Pixels result(size_t{3} * image.width * image.height);
    const auto viewed = [](const PixelView& view) {
      return xrdsInterleavedImage(const_cast<float*>(view.pixels), XRDS_FLOAT, 3, view.width, view.height);
    };
    std::vector<XrdsImage> images;
    for (const PixelView& guide : guides) images.push_back(viewed(guide));
    const XrdsImage from = viewed(image), to = rgb(result, image.width, image.height);
    EXPECT_EQ(xrdsUpscale(made, &from, images.data(), static_cast<uint32_t>(images.size()), &to, nullptr, nullptr),
              XRDS_OK)
        << xrdsGetMessage();
    xrdsDestroyUpscaler(made);
    return result;
  }

  // The images of the frame without their noise.
  void denoise(uint32_t passes) {
    albedo = denoising::denoisedAlbedo({albedo.data(), kWide, kHigh},
                                       [&](const PixelView& image) { return through(networks[1], image, {}); });
    normal = through(networks[2], {normal.data(), kWide, kHigh}, {});
    means[0] = denoising::boxMean({albedo.data(), kWide, kHigh}, kScale);
    means[1] = denoising::boxMean({normal.data(), kWide, kHigh}, kScale);
    colourPixels = denoised(colourPixels, passes);
    for (int i = 0; i < 2; ++i) auxiliary[i] = rgb(i ? normal : albedo, kWide, kHigh);
    colour = rgb(colourPixels, kWidth, kHeight);
  }

  Pixels denoised(const Pixels& light, uint32_t passes) {
    const PixelView guides[] = {{means[0].data(), kWidth, kHeight}, {means[1].data(), kWidth, kHeight}};
    const auto network = [&](const PixelView& image, std::span<const PixelView> turned) {
      return through(networks[0], image, turned);
    };
    return denoising::denoisedRadiance({light.data(), kWidth, kHeight}, guides, passes, network);
  }

  // The options with denoisers, and without them for images that went through these.
  void setDenoisers(XrdsUpscalerOptions& options) const {
    options.denoiser = networks[0];
    options.albedoDenoiser = networks[1];
    options.normalDenoiser = networks[2];
  }

  void expectSame(XrdsUpscalerOptions options) {
    xrdsDestroyUpscaler(upscaler);
    XrdsUpscalerOptions first = options;
    setDenoisers(first);
    upscaler = create(model, kWidth, kHeight, first);
    const Pixels given[] = {colourPixels, albedo, normal};
    ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
    const Pixels found = outputPixels;
    xrdsDestroyUpscaler(upscaler);
    options.denoisedColour = 1;
    upscaler = create(model, kWidth, kHeight, options);
    denoise(options.ensemble);
    ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
    EXPECT_EQ(found, outputPixels);
    colourPixels = given[0], albedo = given[1], normal = given[2];
    colour = rgb(colourPixels, kWidth, kHeight);
    for (int i = 0; i < 2; ++i) auxiliary[i] = rgb(i ? normal : albedo, kWide, kHigh);
  }

  XrdsModel* networks[3] = {};
  Pixels means[2];
};

TEST_F(CApiDenoising, OneAfterTheOtherIsWhatEachGives) {
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.ensemble = 8;
  expectSame(options);
  options = xrdsUpscalerOptionsDefault();
  options.wrap = 1;
  options.ensemble = 2;
  expectSame(options);
  options = xrdsUpscalerOptionsDefault();
  options.skipBound = 0.05F;
  expectSame(options);
  options = xrdsUpscalerOptionsDefault();
  options.memoryBytes = uint64_t{64} << 20;
  options.separateDenoisers = 1;
  expectSame(options);
}

TEST_F(CApiDenoising, KeepsWindowsThatDidNotChange) {
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.keepUnchanged = 1;
  options.exactTiles = 1;
  setDenoisers(options);
  xrdsDestroyUpscaler(upscaler);
  upscaler = create(model, kWidth, kHeight, options);
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  const Pixels before = outputPixels;
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(before, outputPixels);
  XrdsSkipMap map{.structSize = sizeof map};
  ASSERT_EQ(xrdsGetSkipMap(upscaler, &map, nullptr, 0), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(map.work, 0);
}

// Its last bytes were padding, in which anything may be.
TEST_F(CApiDenoising, TakesOptionsOfAnOlderHeader) {
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.profile = 1;
  options.separateDenoisers = 0x5A5A;
  setDenoisers(options);
  const auto isInFront = [&](size_t size) {
    options.structSize = static_cast<uint32_t>(size);
    xrdsDestroyUpscaler(upscaler);
    upscaler = create(model, kWidth, kHeight, options);
    EXPECT_EQ(run(), XRDS_OK) << xrdsGetMessage();
    bool found = false;
    const auto hear = [](void* user, const XrdsProfileRow* row) {
      if (std::string(row->label) == "add_excess") *static_cast<bool*>(user) = true;
    };
    EXPECT_EQ(xrdsGetProfile(upscaler, hear, &found), XRDS_OK) << xrdsGetMessage();
    return found;
  };
  EXPECT_TRUE(isInFront(offsetof(XrdsUpscalerOptions, levelColour)));
  EXPECT_FALSE(isInFront(sizeof options));
}

TEST_F(CApiDenoising, DenoisesEachLayer) {
  Pixels light = noise(3 * kWidth * kHeight, 7), other(colourPixels), black(light.size()), outputs[3];
  for (size_t i = 0; i < light.size(); ++i) {
    light[i] *= 0.25F;
    other[i] *= 0.5F;
    colourPixels[i] = light[i] + 2 * other[i];  // half of the other is missing
  }
  for (Pixels& output : outputs) output.resize(outputPixels.size());
  Pixels* const lights[] = {&light, &other, &black};
  XrdsLayer layers[3];
  const auto give = [&] {
    for (int i = 0; i < 3; ++i) {
      layers[i] = xrdsLayerDefault();
      layers[i].light = rgb(*lights[i], kWidth, kHeight);
      layers[i].output = rgb(outputs[i], kWide, kHigh);
    }
  };
  XrdsLayerSet set = xrdsLayerSetDefault();
  set.layers = layers;
  set.layerCount = 3;
  XrdsLayerReport report{.structSize = sizeof report};
  const auto upscale = [&] {
    give();
    colour = rgb(colourPixels, kWidth, kHeight);
    ASSERT_EQ(xrdsUpscaleLayers(upscaler, &colour, auxiliary, 2, &output, &set, 1, &report, nullptr, nullptr), XRDS_OK)
        << xrdsGetMessage();
  };
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  setDenoisers(options);
  xrdsDestroyUpscaler(upscaler);
  upscaler = create(model, kWidth, kHeight, options);
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  const Pixels inFront = outputPixels;
  upscale();
  const Pixels found = outputPixels, parts[] = {outputs[0], outputs[1], outputs[2]};
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();  // in front again
  EXPECT_EQ(outputPixels, inFront);
  EXPECT_EQ(parts[2], Pixels(parts[2].size()));
  EXPECT_LT(report.share, 0.95);

  xrdsDestroyUpscaler(upscaler);
  options = xrdsUpscalerOptionsDefault();
  options.denoisedColour = 1;
  upscaler = create(model, kWidth, kHeight, options);
  const Pixels radiances[] = {light, other, black};
  Pixels rest = denoising::restOfLayers(colourPixels, radiances).pixels;
  denoise(1);
  for (Pixels* const pixels : {&light, &other, &rest}) *pixels = denoised(*pixels, 1);
  const Pixels clean[] = {light, other, black};
  Pixels whole = denoising::sumOfLayers(rest, clean);
  const XrdsImage wholeImage = rgb(whole, kWidth, kHeight);
  set.whole = &wholeImage;
  upscale();
  EXPECT_EQ(found, outputPixels);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(parts[i], outputs[i]) << i;
}

}  // namespace
}  // namespace xrds
