// Denoisers on a device that has less memory than it says.
#include <span>
#include <string>
#include <utility>

#include "tests/embedded.h"

namespace xrds {
namespace {

using namespace test;

class EmbeddedMemory : public Embedded {
 public:
  void SetUp() override {
    const char* const names[] = {"hdr_albedo_normal_large", "albedo_small", "normal_small"};
    for (int i = 0; i < 3; ++i) {
      const std::string file = std::string(XRDS_GOLDEN_FOLDER) + "/unet/" + names[i] + ".model.safetensors";
      ASSERT_EQ(xrdsOpenModel(file.c_str(), &networks[i]), XRDS_OK) << xrdsGetMessage();
    }
    options.denoiser = networks[0];
    options.albedoDenoiser = networks[1];
    options.normalDenoiser = networks[2];
  }
  void TearDown() override {
    VulkanHost::fail(nullptr, VK_SUCCESS);
    VulkanHost::limitMemory({});
    for (XrdsModel* network : networks) xrdsCloseModel(network);
    Embedded::TearDown();
  }

  // One frame, whose shares of progress must not go back.
  XrdsResult run(XrdsProgress progress = nullptr) { return upscale(progress, {}); }
  XrdsResult runWithLayer(XrdsProgress progress = nullptr) {
    std::vector<float> light = pixels[0], lit(pixels[1].size());
    XrdsLayer layer = xrdsLayerDefault();
    layer.light = rgb(light, width, height);
    layer.output = rgb(lit, scale * width, scale * height);
    XrdsLayerSet set = xrdsLayerSetDefault();
    set.layers = &layer;
    set.layerCount = 1;
    return upscale(progress, {&set, 1});
  }
  XrdsResult upscale(XrdsProgress progress, std::span<const XrdsLayerSet> sets) {
    struct Heard {
      XrdsProgress progress;
      double last = 0;
    } heard{progress};
    const auto hear = [](void* user, double share) {
      Heard& heard = *static_cast<Heard*>(user);
      EXPECT_GE(share, heard.last);
      EXPECT_LE(share, 1);
      heard.last = share;
      return heard.progress ? heard.progress(nullptr, share) : 1;
    };
    const uint32_t w = scale * width, h = scale * height;
    output.assign(size_t{3} * w * h, -1);
    const XrdsImage colour = rgb(pixels[0], width, height), to = rgb(output, w, h);
    const XrdsImage auxiliary[] = {rgb(pixels[1], w, h), rgb(pixels[2], w, h)};
    return xrdsUpscaleLayers(upscaler, &colour, auxiliary, 2, &to, sets.data(), static_cast<uint32_t>(sets.size()),
                             nullptr, hear, &heard);
  }

  XrdsModel* networks[3] = {};
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  std::vector<float> output;
  uint32_t scale = kScale;
};

// Where a network finds no room, the others go, and then the upscaler, which comes back: the bits stay the same.
TEST_F(EmbeddedMemory, ADenoiserFindsRoomWhereTheUpscalerWas) {
  options.ensemble = 8;
  open(14, 9, options);
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  const std::vector<float> expected = output;
  const float exposure = xrdsGetExposure(upscaler);
  constexpr uint64_t kMost = uint64_t{16} << 20, kStep = uint64_t{512} << 10;
  int without = 0;
  for (uint64_t bytes = kMost; bytes > 0; bytes -= kStep) {
    VulkanHost::limitMemory({});
    xrdsDestroyUpscaler(std::exchange(upscaler, nullptr));
    VulkanHost::limitMemory(bytes);
    if (xrdsCreateUpscaler(device, model, width, height, &options, &upscaler) != XRDS_OK) break;
    const uint64_t own = xrdsGetDeviceBytes(upscaler);
    for (int frame = 0; frame < 2; ++frame) {
      ASSERT_EQ(run(), XRDS_OK) << bytes << ": " << xrdsGetMessage();
      EXPECT_EQ(output, expected) << bytes;
      EXPECT_EQ(xrdsGetExposure(upscaler), exposure);
      without += xrdsGetDeviceBytes(upscaler) == own;  // the networks gave theirs back
    }
  }
  EXPECT_GT(without, 0);
}

TEST_F(EmbeddedMemory, TheExposureOfTheLastFrameStaysWhereOneIsCancelled) {
  options.separateDenoisers = 1;
  open(14, 9, options);
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  const float exposure = xrdsGetExposure(upscaler);
  const uint64_t networks = xrdsGetDeviceBytes(upscaler);
  VulkanHost::limitMemory(0);
  const auto never = [](void*, double share) { return share < 0.5 ? 1 : 0; };
  ASSERT_EQ(run(never), XRDS_CANCELLED) << xrdsGetMessage();
  VulkanHost::limitMemory({});
  EXPECT_EQ(xrdsGetExposure(upscaler), exposure);
  ASSERT_EQ(runWithLayer(never), XRDS_CANCELLED) << xrdsGetMessage();
  EXPECT_EQ(xrdsGetExposure(upscaler), exposure);
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(xrdsGetExposure(upscaler), exposure);
  EXPECT_EQ(xrdsGetDeviceBytes(upscaler), networks);
}

// Denoisers that find no room in front for one frame have it again for the next, and can be recorded.
TEST_F(EmbeddedMemory, DenoisersComeBackInFront) {
  open(14, 9, options);
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  const std::vector<float> inFront = output;
  ASSERT_EQ(runWithLayer(), XRDS_OK) << xrdsGetMessage();
  VulkanHost::fail("vkAllocateMemory", VK_ERROR_OUT_OF_DEVICE_MEMORY);
  for (int frame = 0; frame < 2; ++frame) EXPECT_EQ(run(), XRDS_ERROR_OUT_OF_MEMORY);
  EXPECT_EQ(xrdsGetDeviceBytes(upscaler), 0);
  VulkanHost::fail(nullptr, VK_SUCCESS);
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(output, inFront);
  Frame mine = frame();
  Embedded::run(mine);
  EXPECT_EQ(get(mine.output), inFront);
}

TEST_F(EmbeddedMemory, LayersGoBeforeAndBehindARecording) {
  open(14, 9, options);
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  const std::vector<float> inFront = output;
  ASSERT_EQ(runWithLayer(), XRDS_OK) << xrdsGetMessage();
  const float exposure = xrdsGetExposure(upscaler);
  const std::vector<float> withLayer = output;
  Frame mine = frame();
  Embedded::run(mine);
  EXPECT_EQ(get(mine.output), inFront);
  EXPECT_EQ(xrdsGetExposure(upscaler), exposure);
  EXPECT_EQ(runWithLayer(), XRDS_ERROR_ARGUMENT);
  EXPECT_NE(std::string(xrdsGetMessage()).find("recording"), std::string::npos) << xrdsGetMessage();
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(output, inFront);
  host->submit(recorded(mine));
  host->await();
  EXPECT_EQ(get(mine.output), inFront);
  xrdsDestroyRecording(std::exchange(recordings.back(), nullptr));
  ASSERT_EQ(runWithLayer(), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(output, withLayer);
}

// Tiles of half the memory that the upscaler alone took are no smaller ones for all networks.
TEST_F(EmbeddedMemory, ALargeFrameThatFindsNoRoomAfterLayersEnds) {
  open(14, 9, options);
  xrdsCloseModel(std::exchange(model, nullptr));
  xrdsDestroyUpscaler(std::exchange(upscaler, nullptr));
  const std::string file = std::string(XRDS_GOLDEN_FOLDER) + "/s2_paper_width.model.safetensors";
  ASSERT_EQ(xrdsOpenModel(file.c_str(), &model), XRDS_OK) << xrdsGetMessage();
  width = 128, height = 96, scale = 2;
  pixels[0] = noise(size_t{3} * width * height, 1);
  for (int i = 1; i < 3; ++i) pixels[i] = noise(size_t{3} * scale * scale * width * height, 1 + i);
  ASSERT_EQ(xrdsCreateUpscaler(device, model, width, height, &options, &upscaler), XRDS_OK) << xrdsGetMessage();
  ASSERT_EQ(runWithLayer(), XRDS_OK) << xrdsGetMessage();
  VulkanHost::fail("vkAllocateMemory", VK_ERROR_OUT_OF_DEVICE_MEMORY);
  EXPECT_EQ(run(), XRDS_ERROR_OUT_OF_MEMORY);
  VulkanHost::fail(nullptr, VK_SUCCESS);
  EXPECT_EQ(run(), XRDS_OK) << xrdsGetMessage();
}

}  // namespace
}  // namespace xrds
