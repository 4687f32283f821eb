// Denoisers in front of an upscaler in the C++ API, where they run one after the other: bit for bit what the command
// makes of the same frame and options.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "app/frame.h"
#include "app/network_denoiser.h"
#include "app/upscale_frame.h"
#include "tests/temporary_folder.h"
#include "tests/uniform_numbers.h"

namespace xrds {
namespace {

constexpr int kWidth = 23, kHeight = 14, kScale = 2;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

std::filesystem::path golden(const std::string& name) {
  return std::filesystem::path(XRDS_GOLDEN_FOLDER) / (name + ".model.safetensors");
}

Image noise(int scale, float least, float most, uint32_t seed) {
  const int width = scale * kWidth, height = scale * kHeight;
  return {width, height, 3, test::uniformNumbers(size_t{3} * width * height, least, most, seed)};
}

void write(const std::filesystem::path& path, const std::vector<std::pair<std::string, Image>>& layers) {
  std::vector<ExrPlane> planes;
  const Image& first = layers.front().second;
  const Box window{0, 0, first.width - 1, first.height - 1};
  for (const auto& [name, image] : layers) {
    const std::string last = name == "Normal" ? "XYZ" : "RGB";
    std::vector<std::string> names;
    for (const char c : last) names.push_back(name + "." + c);
    for (ExrPlane& plane : planesOf(image, names, ExrPixelType::kFloat)) planes.push_back(std::move(plane));
  }
  writeExr(path, planes, {.dataWindow = window, .displayWindow = window});
}

class DenoisingFirst : public testing::Test {
 protected:
  void SetUp() override {
    for (const auto& [name, file] :
         {std::pair("rt_hdr_calb_cnrm_large", "unet/hdr_albedo_normal_large"),
          std::pair("rt_hdr_alb", "unet/hdr_albedo_base"), std::pair("rt_alb", "unet/albedo_small"),
          std::pair("rt_nrm", "unet/normal_small")})
      std::filesystem::copy_file(golden(file), folder_ / (std::string(name) + ".safetensors"));
    Image colour = noise(1, 0.1F, 2, 1), albedo = noise(kScale, 0, 1.5F, 2), diffuse = noise(1, 0, 1, 5);
    const Image pass = noise(1, 0.1F, 1, 6), emission = noise(1, 0, 0.1F, 7);
    for (size_t i = 0; i < colour.pixels.size() / 2; ++i)
      colour.pixels[i] = diffuse.pixels[i] * pass.pixels[i] + emission.pixels[i];
    colour.at(3, 4, 1) = kNone;
    colour.at(5, 5, 0) = -1;
    albedo.at(9, 9, 2) = kNone;
    diffuse.at(2, 2, 2) = kNone;
    write(folder_ / "colour.exr", {{"Combined", colour},
                                   {"DiffDir", diffuse},
                                   {"DiffCol", pass},
                                   {"Emit", emission},
                                   {"Env", Image(kWidth, kHeight, 3)}});
    write(folder_ / "full.exr",
          {{"Albedo", albedo}, {"Normal", noise(kScale, -1, 1, 3)}, {"DiffCol", noise(kScale, 0.1F, 1, 8)}});
    write(folder_ / "beauty.exr", {{"Combined", noise(kScale, 0, 2, 4)}, {"Albedo", albedo}});
  }

  Frame loaded(const Model& model, const std::string& full) const {
    MergeRequest merge;
    if (full == "beauty.exr") merge.samples = RenderSamples{4, 1};
    Frame frame(folder_ / "colour.exr", folder_ / full, {}, model.auxiliaryInputs(), merge);
    frame.load();
    return frame;
  }

  /// The picture and the layers of both ways, of which the first is the command's.
  struct Both {
    Image picture[2];
    UpscaledLayers layers[2];
  };

  Both upscaled(const Model& model, const std::string& full, Upscaler::Options options, bool clean, bool withLayers) {
    Frame frame = loaded(model, full);
    if (withLayers) frame.loadLayers({.all = true}, kScale);
    NetworkDenoiser networks(
        {.folder = folder_.path(), .fp16 = options.fp16, .memoryBytes = options.tiles.memoryBytes});
    const Frame given = frame;
    DeviceDenoiser denoiser(networks, device_);
    frame.denoise(denoiser, clean, options.ensemble);
    options.denoisedColour = true;
    Both both;
    Upscaler behind(device_, model, frame.width(), frame.height(), options);
    options.denoisedColour = false;
    options.denoisers = networks.inFront(given.imageOf(kAlbedo.name), given.imageOf(kNormal.name), clean);
    options.denoisers.separate = options.tiles.memoryBytes > 0;
    options.denoisers.level = frame.merged().has_value();
    Upscaler whole(device_, model, frame.width(), frame.height(), options);
    const Frame* const frames[] = {&frame, &given};
    Upscaler* const upscalers[] = {&behind, &whole};
    for (const int way : {0, 1, 1}) {  // twice as networks stay ready
      Image& picture = both.picture[way] = Image(kScale * kWidth, kScale * kHeight, 3);
      if (!withLayers) {
        EXPECT_TRUE(way == 0 ? upscaleFrame(behind, model, frame, picture.pixels, {})
                             : whole.run(viewOf(given.colour()), inputsOf(model, given), picture.pixels, progress_));
        continue;
      }
      both.layers[way] = given.layers()->room(kScale);
      auto sets = frames[way]->layers()->sets(both.layers[way]);
      if (way == 1)
        for (LayerSet& set : sets) set.whole = {};  // the colour
      EXPECT_TRUE(upscalers[way]->run(viewOf(frames[way]->colour()), inputsOf(model, *frames[way]), picture.pixels,
                                      sets, way ? progress_ : Upscaler::Progress()));
      both.layers[way].reports = upscalers[way]->layerReports();
      if (way == 0) both.layers[0].reports = frame.layers()->reports(both.layers[0].reports);
    }
    EXPECT_EQ(whole.exposure(), behind.exposure());
    return both;
  }

  void expectSame(const std::string& name, const std::string& full, const Upscaler::Options& options,
                  bool clean = false, bool withLayers = false) {
    const Both both = upscaled(Model(golden(name)), full, options, clean, withLayers);
    EXPECT_EQ(both.picture[0].pixels, both.picture[1].pixels);
    const auto same = [](const std::vector<Image>& a, const std::vector<Image>& b) {
      ASSERT_EQ(a.size(), b.size());
      for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].pixels, b[i].pixels) << i;
    };
    same(both.layers[0].lights, both.layers[1].lights);
    same(both.layers[0].colours, both.layers[1].colours);
    for (size_t i = 0; i < both.layers[0].reports.size(); ++i)
      EXPECT_EQ(both.layers[0].reports[i].share, both.layers[1].reports.at(i).share);
    EXPECT_FALSE(shares_.empty());
    EXPECT_NEAR(shares_.back(), options.skip.keepUnchanged ? 0.75 : 1, 1e-9);  // of what did not change nothing runs
  }

  test::TemporaryFolder folder_;
  Device device_;
  std::vector<double> shares_;
  const Upscaler::Progress progress_ = [this](double share) {
    EXPECT_GE(share, 0);
    EXPECT_LE(share, 1 + 1e-9);
    shares_.push_back(share);
    return true;
  };
};

TEST_F(DenoisingFirst, OfEnsemblesIsThatOfTheCommand) {
  for (const uint32_t passes : {2U, 4U, 8U}) expectSame("s2_guided", "full.exr", {.ensemble = passes}, passes == 4);
  expectSame("s2_guided", "full.exr", {.fp16 = true, .exposure = 0.7F, .ensemble = 2});
}

// A model that takes the full-resolution colour makes a share of the picture of the images with their noise.
TEST_F(DenoisingFirst, OfFullResolutionColoursIsThatOfTheCommand) {
  for (const uint32_t passes : {2U, 8U}) expectSame("s2_full_colour_first", "beauty.exr", {.ensemble = passes});
  expectSame("s2_full_colour_first", "beauty.exr", {.tiles = {.memoryBytes = uint64_t{64} << 20}});
}

TEST_F(DenoisingFirst, OfWindowsPanoramasAndMemoryIsThatOfTheCommand) {
  expectSame("s2_guided", "full.exr", {.skip = {.bound = 0.05F}});
  expectSame("s2_guided", "full.exr", {.exposure = 1.F, .skip = {.keepUnchanged = true}});
  expectSame("s2_guided", "full.exr", {.ensemble = 4, .tiles = {.wrap = true}});
  expectSame("s2_guided", "full.exr", {.tiles = {.memoryBytes = uint64_t{64} << 20}});
}

TEST_F(DenoisingFirst, OfLayersIsThatOfTheCommand) {
  expectSame("s2_guided", "full.exr", {}, false, true);
  expectSame("s2_guided", "full.exr", {.ensemble = 2}, true, true);
}

}  // namespace
}  // namespace xrds
