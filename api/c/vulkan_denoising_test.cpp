// Recordings with a denoiser in front: the same pictures as xrdsUpscale() gives, and denoisers alone.
#include "tests/embedded.h"

namespace xrds {
namespace {

using test::Embedded;
using test::noise;

const std::string kNetworks = std::string(XRDS_GOLDEN_FOLDER) + "/unet/";

class EmbeddedDenoising : public Embedded {
 public:
  void SetUp() override {
    const char* const names[] = {"hdr_albedo_normal_large", "albedo_small", "normal_small"};
    for (int i = 0; i < 3; ++i)
      ASSERT_EQ(xrdsOpenModel((kNetworks + names[i] + ".model.safetensors").c_str(), &networks_[i]), XRDS_OK);
    XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
    options.denoiser = networks_[0];
    options.albedoDenoiser = networks_[1];
    options.normalDenoiser = networks_[2];
    open(14, 9, options);
    for (XrdsModel* network : networks_) xrdsCloseModel(network);  // the upscaler keeps them
  }

 private:
  XrdsModel* networks_[3] = {};
};

TEST_F(EmbeddedDenoising, GivesThePictureOfUpscale) {
  Frame mine = frame();
  run(mine);
  EXPECT_EQ(get(mine.output), expected());
  pixels[0] = noise(pixels[0].size(), 9);
  set(mine.colour, pixels[0]);
  run(mine);
  EXPECT_EQ(get(mine.output), expected());
}

TEST_F(EmbeddedDenoising, TakesImagesAndAlpha) {
  const std::vector<float> wanted = expected();
  Frame mine = frame({XRDS_FLOAT, 4}, {XRDS_FLOAT, 4});
  XrdsVulkanImage* images[] = {&mine.frame.colour, &mine.images[0], &mine.images[1]};
  const Picture* buffers[] = {&mine.colour, &mine.auxiliary[0], &mine.auxiliary[1]};
  for (uint32_t i = 0; i < width * height; ++i) setNumber(mine.colour, i % width, i / width, 3, 0.25F);
  mine.frame.alpha = &mine.frame.colour;
  const VkCommandBuffer fill = host->begin();
  for (size_t i = 0; i < 3; ++i) {
    const uint32_t w = buffers[i]->image.width, h = buffers[i]->image.height;
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    *images[i] = xrdsWholeImage(host->image(w, h, VK_FORMAT_R32G32B32A32_SFLOAT, usage).image, XRDS_FLOAT, w, h);
    images[i]->layout = VK_IMAGE_LAYOUT_GENERAL;
    host->transition(fill, images[i]->image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    host->copy(fill, buffers[i]->memory.buffer, images[i]->image, w, h, true);
    host->transition(fill, images[i]->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL);
  }
  host->end(fill);
  host->submit(fill);
  run(mine);
  EXPECT_EQ(get(mine.output), wanted);
  EXPECT_EQ(number(mine.output, 3, 5, 3), 0.25F);
}

// Open Image Denoise's networks by themselves, whose exposure is computed on the device.
TEST_F(EmbeddedDenoising, RecordsADenoiserWithoutAGivenExposure) {
  xrdsDestroyUpscaler(upscaler);
  upscaler = nullptr;
  XrdsModel* network = nullptr;
  ASSERT_EQ(xrdsOpenModel((kNetworks + "hdr_small.model.safetensors").c_str(), &network), XRDS_OK);
  ASSERT_EQ(xrdsCreateUpscaler(device, network, width, height, nullptr, &upscaler), XRDS_OK) << xrdsGetMessage();
  xrdsCloseModel(network);
  const Picture colour = picture(width, height, {}), output = picture(width, height, {});
  set(colour, pixels[0]);
  XrdsVulkanFrame given = xrdsVulkanFrameDefault();
  given.colour = colour.image;
  given.output = output.image;
  XrdsRecording* recording = nullptr;
  ASSERT_EQ(xrdsCreateRecording(upscaler, &given, &recording), XRDS_OK) << xrdsGetMessage();
  recordings.push_back(recording);
  ASSERT_EQ(xrdsRun(recording, nullptr, nullptr), XRDS_OK) << xrdsGetMessage();
  const std::vector<float> found = get(output);
  std::vector<float> wanted(pixels[0].size());
  const XrdsImage low = test::rgb(pixels[0], width, height), made = test::rgb(wanted, width, height);
  ASSERT_EQ(xrdsUpscale(upscaler, &low, nullptr, 0, &made, nullptr, nullptr), XRDS_OK) << xrdsGetMessage();
  EXPECT_NEAR(xrdsGetRecordingExposure(recording) / xrdsGetExposure(upscaler), 1, 2e-6);
  for (size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], wanted[i], 1e-4F * (0.1F + wanted[i])) << i;
}

TEST_F(EmbeddedDenoising, RefusesWhatIsNoHandle) {
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.denoiser = reinterpret_cast<const XrdsModel*>(this);
  XrdsUpscaler* made = nullptr;
  EXPECT_EQ(xrdsCreateUpscaler(device, model, 14, 9, &options, &made), XRDS_ERROR_ARGUMENT);
  EXPECT_NE(std::string(xrdsGetMessage()).find("denoiser"), std::string::npos) << xrdsGetMessage();
}

}  // namespace
}  // namespace xrds
