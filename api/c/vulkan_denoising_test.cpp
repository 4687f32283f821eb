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

TEST_F(EmbeddedDenoising, RefusesWhatIsNoHandle) {
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.denoiser = reinterpret_cast<const XrdsModel*>(this);
  XrdsUpscaler* made = nullptr;
  EXPECT_EQ(xrdsCreateUpscaler(device, model, 14, 9, &options, &made), XRDS_ERROR_ARGUMENT);
  EXPECT_NE(std::string(xrdsGetMessage()).find("denoiser"), std::string::npos) << xrdsGetMessage();
}

}  // namespace
}  // namespace xrds
