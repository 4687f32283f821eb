// Denoisers in front of an upscaler from run to run: cancelled at each share of the progress, with layers and without,
// the next run is as of a new upscaler, and what is told of the last one stays.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/uniform_numbers.h"
#include "xrds/xrds.hpp"

namespace xrds {
namespace {

constexpr uint32_t kWidth = 14, kHeight = 9, kScale = 2;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

using Pixels = std::vector<float>;

Device& device() {
  static Device device;
  return device;
}

Model golden(const std::string& name) {
  return Model(std::string(XRDS_GOLDEN_FOLDER) + "/" + name + ".model.safetensors");
}

Pixels noise(uint32_t scale, float least, float most, uint32_t seed) {
  return test::uniformNumbers(size_t{3} * scale * scale * kWidth * kHeight, least, most, seed);
}

PixelView viewOf(const Pixels& pixels, uint32_t scale) { return {pixels.data(), scale * kWidth, scale * kHeight}; }

/// A frame with a pixel that is not finite, two layers, and what became of them.
struct RunFrame {
  explicit RunFrame(const Model& model, uint32_t seed) {
    for (const std::string& input : model.auxiliaryInputs())
      images.push_back(noise(kScale, input == "normal" ? -1.F : 0.F, 1.5F, ++seed));
    colour[7] = images[0][11] = kNone;
  }
  bool run(Upscaler& upscaler, bool withLayers, const Upscaler::Progress& progress = {}) {
    std::vector<PixelView> views;
    for (const Pixels& image : images) views.push_back(viewOf(image, kScale));
    LayerSet set;
    for (int i = 0; i < 2; ++i) set.lights.push_back({.light = viewOf(lights[i], 1), .output = outputs[i]});
    const std::span sets(&set, withLayers ? 1 : 0);
    return upscaler.run(viewOf(colour, 1), views, picture, sets, progress);
  }
  std::vector<Pixels> results() const { return {picture, outputs[0], outputs[1]}; }

  Pixels colour = noise(1, 0, 2, 1), lights[2] = {noise(1, 0, 0.5F, 8), noise(1, 0, 0.7F, 9)};
  std::vector<Pixels> images;
  Pixels picture = Pixels(size_t{3} * kScale * kScale * kWidth * kHeight), outputs[2] = {picture, picture};
};

class DenoisingRuns : public testing::Test {
 protected:
  Upscaler make(const Model& model, Upscaler::Options options) {
    const bool hasNormal = model.auxiliaryInputs().back() == "normal";
    options.denoisers.colour = hasNormal ? &guided_ : &albedoGuided_;
    options.denoisers.albedo = &albedo_;
    options.denoisers.normal = hasNormal ? &normal_ : nullptr;
    options.profile = true;
    return Upscaler(device(), model, kWidth, kHeight, options);
  }

  // Shares rise up to 1.
  static int countShares(Upscaler& upscaler, RunFrame& frame, bool withLayers) {
    double last = 0;
    int count = 0;
    EXPECT_TRUE(frame.run(upscaler, withLayers, [&](double share) {
      EXPECT_GE(share, last);
      EXPECT_LE(share, 1);
      last = share;
      ++count;
      return true;
    }));
    EXPECT_EQ(last, 1);
    return count;
  }

  // At the end-th share. Returns whether there was one: where windows are kept there are fewer.
  static bool cancel(Upscaler& upscaler, RunFrame& frame, bool withLayers, int end) {
    const float exposure = upscaler.exposure();
    const Upscaler::Repairs repairs = upscaler.repairs();
    int calls = 0;
    const bool ended = frame.run(upscaler, withLayers, [&](double) { return ++calls < end; });
    EXPECT_EQ(ended, calls < end);
    upscaler.profile();
    if (ended) return false;
    EXPECT_EQ(calls, end);
    EXPECT_EQ(upscaler.exposure(), exposure);
    EXPECT_EQ(upscaler.repairs().colour, repairs.colour);
    EXPECT_EQ(upscaler.repairs().output, repairs.output);
    return true;
  }

  // Of denoisers, wherever they stand.
  static size_t countRows(const Upscaler& upscaler) {
    const auto rows = upscaler.profile();
    EXPECT_TRUE(
        std::any_of(rows.begin(), rows.end(), [](const auto& row) { return row.label.starts_with("enc_conv"); }));
    return rows.size();
  }

  void expectGoesOn(const Model& model, const Upscaler::Options& options, bool layersBefore, bool layers) {
    RunFrame before(model, 20), frame(model, 40), wanted(model, 40);
    Upscaler fresh = make(model, options);
    const int shares = countShares(fresh, wanted, layers);
    Upscaler upscaler = make(model, options);
    EXPECT_EQ(upscaler.exposure(), 0);
    EXPECT_TRUE(upscaler.profile().empty());
    for (int end = 1; end <= shares; end += 1 + shares / 8) {
      ASSERT_TRUE(before.run(upscaler, layersBefore));
      if (!cancel(upscaler, frame, layers, end)) break;
      ASSERT_TRUE(frame.run(upscaler, layers));
      EXPECT_EQ(frame.results(), wanted.results()) << end << " of " << shares;
      EXPECT_EQ(upscaler.exposure(), fresh.exposure());
      EXPECT_EQ(upscaler.deviceBytes(), fresh.deviceBytes());
      EXPECT_EQ(countRows(upscaler), countRows(fresh));
    }
  }

  const Model guided_ = golden("unet/hdr_albedo_normal_large"), albedoGuided_ = golden("unet/hdr_albedo_base"),
              albedo_ = golden("unet/albedo_small"), normal_ = golden("unet/normal_small"),
              model_ = golden("s2_guided"), full_ = golden("s2_full_colour_first");
};

TEST_F(DenoisingRuns, InFrontAndWithLayers) {
  expectGoesOn(model_, {}, false, false);
  expectGoesOn(model_, {}, true, false);
  expectGoesOn(model_, {}, false, true);
  expectGoesOn(full_, {.denoisers = {.level = true}}, true, true);
}

TEST_F(DenoisingRuns, OfEnsembles) {
  expectGoesOn(model_, {.ensemble = 8}, true, false);
  expectGoesOn(full_, {.ensemble = 2, .denoisers = {.level = true}}, false, false);
  expectGoesOn(full_, {.ensemble = 4, .denoisers = {.level = true}}, false, true);
}

TEST_F(DenoisingRuns, OfSkippedAndKeptWindowsAndPanoramas) {
  expectGoesOn(model_, {.skip = {.bound = 0.01F}}, false, false);
  // Their own exposure follows that of the frames before.
  expectGoesOn(model_, {.exposure = 0.7F, .tiles = {.exact = true}, .skip = {.keepUnchanged = true}}, false, false);
  expectGoesOn(model_, {.tiles = {.wrap = true}}, true, true);
}

}  // namespace
}  // namespace xrds
