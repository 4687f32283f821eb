// A denoiser in front of an upscaler, on the device: what the networks give one after the other through the host.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/harness.h"
#include "tests/uniform_numbers.h"
#include "xrds/merged_colour.h"
#include "xrds/xrds.hpp"

namespace xrds {
namespace {

using test::relativeRms;

constexpr uint32_t kWidth = 92, kHeight = 30, kScale = 2;

Device& device() {
  static Device device;
  return device;
}

Model golden(const std::string& name) {
  return Model(std::string(XRDS_GOLDEN_FOLDER) + "/" + name + ".model.safetensors");
}

using Pixels = std::vector<float>;

PixelView viewOf(const Pixels& pixels, uint32_t scale) { return {pixels.data(), scale * kWidth, scale * kHeight}; }

Pixels noise(uint32_t scale, float least, float most, uint32_t seed) {
  return test::uniformNumbers(size_t{3} * scale * scale * kWidth * kHeight, least, most, seed);
}

Pixels boxMean(const Pixels& full) {
  Pixels mean(full.size() / kScale / kScale);
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x)
      for (uint32_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (uint32_t i = 0; i < kScale * kScale; ++i)
          sum += full[3 * ((kScale * y + i / kScale) * kScale * kWidth + kScale * x + i % kScale) + c];
        mean[3 * (y * kWidth + x) + c] = static_cast<float>(sum / kScale / kScale);
      }
  return mean;
}

Pixels through(const Model& model, const Pixels& colour, uint32_t scale, const std::vector<const Pixels*>& auxiliary,
               const Upscaler::Options& options = {}) {
  const uint32_t factor = model.scale();
  Upscaler upscaler(device(), model, scale * kWidth, scale * kHeight, options);
  std::vector<PixelView> views;
  for (const Pixels* image : auxiliary) views.push_back(viewOf(*image, factor * scale));
  Pixels output(colour.size() * factor * factor);
  EXPECT_TRUE(upscaler.run(viewOf(colour, scale), views, output));
  return output;
}

class Denoising : public testing::Test {
 protected:
  // The albedo as it is denoised, with what it has above 1.
  Pixels cleanAlbedo() const {
    Pixels inside = albedo_;
    for (float& number : inside) number = std::min(std::max(number, 0.F), 1.F);
    Pixels result = through(albedoNetwork_, inside, kScale, {});
    for (size_t i = 0; i < result.size(); ++i) result[i] += albedo_[i] - inside[i];
    return result;
  }

  const Model colourNetwork_ = golden("unet/hdr_albedo_normal_large"), albedoNetwork_ = golden("unet/albedo_small"),
              normalNetwork_ = golden("unet/normal_small"), guided_ = golden("s2_guided");
  const Upscaler::Denoisers denoisers_{&colourNetwork_, &albedoNetwork_, &normalNetwork_};
  const Pixels colour_ = noise(1, 0, 2, 1), albedo_ = noise(kScale, 0, 1.5F, 2), normal_ = noise(kScale, -1, 1, 3);
};

TEST_F(Denoising, IsWhatTheNetworksGiveOneAfterTheOther) {
  const Pixels albedo = cleanAlbedo(), normal = through(normalNetwork_, normal_, kScale, {});
  const Pixels lowAlbedo = boxMean(albedo), lowNormal = boxMean(normal);
  const Pixels colour = through(colourNetwork_, colour_, 1, {&lowAlbedo, &lowNormal});
  const Pixels expected = through(guided_, colour, 1, {&albedo, &normal});
  EXPECT_LT(relativeRms(through(guided_, colour_, 1, {&albedo_, &normal_}, {.denoisers = denoisers_}), expected), 1e-6);
  EXPECT_GT(relativeRms(through(guided_, colour_, 1, {&albedo_, &normal_}), expected), 1e-2);
}

// Of what this model changes in a denoised colour, 0.75 where it makes it darker, 0.25 where brighter.
TEST_F(Denoising, TakesThePartOfTheChangeThatTheModelStates) {
  const Model restrained = golden("s1_restrained");
  const Pixels albedo = noise(1, 0, 1, 2), normal = noise(1, -1, 1, 3);
  const auto run = [&](const Pixels& colour, const Upscaler::Options& options) {
    return through(restrained, colour, 1, {&albedo, &normal}, options);
  };
  const Pixels clean = through(colourNetwork_, colour_, 1, {&albedo, &normal});
  Pixels expected = run(clean, {});
  for (size_t i = 0; i < expected.size(); ++i)
    expected[i] = clean[i] + (expected[i] < clean[i] ? 0.75F : 0.25F) * (expected[i] - clean[i]);
  EXPECT_GT(relativeRms(run(clean, {}), expected), 1e-2);
  EXPECT_LT(relativeRms(run(clean, {.denoisedColour = true}), expected), 1e-6);
  EXPECT_LT(relativeRms(run(colour_, {.denoisers = {.colour = &colourNetwork_}}), expected), 1e-6);
  const TileOptions inTiles{.exact = true, .columns = 2};
  EXPECT_EQ(run(clean, {.tiles = inTiles, .denoisedColour = true}), run(clean, {.denoisedColour = true}));
  EXPECT_NE(run(clean, {.ensemble = 2}), run(clean, {.ensemble = 2, .denoisedColour = true}));
}

// Of other models all of it.
TEST_F(Denoising, LeavesModelsAsTheyAreThatStateNoPart) {
  const Model model = golden("s1_kernels_aux_skip");
  const Pixels albedo = noise(1, 0, 1, 2), normal = noise(1, -1, 1, 3);
  EXPECT_EQ(through(model, colour_, 1, {&albedo, &normal}, {.denoisedColour = true}),
            through(model, colour_, 1, {&albedo, &normal}));
}

TEST_F(Denoising, TakesCleanGuidesAsTheyAre) {
  const Pixels lowAlbedo = boxMean(albedo_), lowNormal = boxMean(normal_);
  const Pixels colour = through(colourNetwork_, colour_, 1, {&lowAlbedo, &lowNormal});
  const Pixels expected = through(guided_, colour, 1, {&albedo_, &normal_});
  const Upscaler::Options options{.denoisers = {.colour = &colourNetwork_}};
  EXPECT_LT(relativeRms(through(guided_, colour_, 1, {&albedo_, &normal_}, options), expected), 1e-6);
}

// A model whose first input is the full-resolution colour, and a denoiser with one guide.
TEST_F(Denoising, DenoisesTheFullResolutionColourWithTheGuides) {
  const Model model = golden("s2_full_colour_first"), network = golden("unet/hdr_albedo_base");
  ASSERT_EQ(model.auxiliaryInputs(), (std::vector<std::string>{"colour", "albedo"}));
  const Pixels full = noise(kScale, 0, 2, 4), albedo = cleanAlbedo(), lowAlbedo = boxMean(albedo);
  const Pixels clean = through(network, full, kScale, {&albedo}), colour = through(network, colour_, 1, {&lowAlbedo});
  const Pixels expected = through(model, colour, 1, {&clean, &albedo});
  const Upscaler::Options options{.denoisers = {.colour = &network, .albedo = &albedoNetwork_}};
  EXPECT_LT(relativeRms(through(model, colour_, 1, {&full, &albedo_}, options), expected), 1e-6);
}

TEST_F(Denoising, TakesAnExposureForTheUpscaler) {
  const Pixels once = through(guided_, colour_, 1, {&albedo_, &normal_}, {.exposure = 0.5F, .denoisers = denoisers_});
  Upscaler upscaler(device(), guided_, kWidth, kHeight, {.denoisers = denoisers_});
  const PixelView views[] = {viewOf(albedo_, kScale), viewOf(normal_, kScale)};
  Pixels output(once.size());
  ASSERT_TRUE(upscaler.run(viewOf(colour_, 1), views, output));
  EXPECT_NE(output, once);
  const Upscaler::Options options{.exposure = upscaler.exposure(), .denoisers = denoisers_};
  EXPECT_LT(relativeRms(through(guided_, colour_, 1, {&albedo_, &normal_}, options), output), 1e-6);
}

// Also run after run, and with halves; of the tiles the exact halo gives every bit.
TEST_F(Denoising, IsTheSameInTilesOfTheUpscaler) {
  for (const bool fp16 : {false, true}) {
    Upscaler::Options options{.fp16 = fp16, .exposure = 0.8F, .denoisers = denoisers_};
    const Pixels whole = through(guided_, colour_, 1, {&albedo_, &normal_}, options);
    options.tiles = {.exact = true, .columns = 2, .rows = 1};
    EXPECT_EQ(through(guided_, colour_, 1, {&albedo_, &normal_}, options), whole);
    Upscaler upscaler(device(), guided_, kWidth, kHeight, options);
    const PixelView views[] = {viewOf(albedo_, kScale), viewOf(normal_, kScale)};
    for (int run = 0; run < 2; ++run) {
      Pixels output(whole.size());
      ASSERT_TRUE(upscaler.run(viewOf(colour_, 1), views, output));
      EXPECT_EQ(output, whole) << run;
    }
  }
}

TEST_F(Denoising, TellsItsTimesItsProgressAndItsEnd) {
  Upscaler upscaler(device(), guided_, kWidth, kHeight, {.profile = true, .denoisers = denoisers_});
  const PixelView views[] = {viewOf(albedo_, kScale), viewOf(normal_, kScale)};
  Pixels output(size_t{3} * kScale * kScale * kWidth * kHeight);
  std::vector<double> shares;
  ASSERT_TRUE(upscaler.run(viewOf(colour_, 1), views, output, [&](double share) {
    shares.push_back(share);
    return true;
  }));
  ASSERT_FALSE(shares.empty());
  EXPECT_EQ(shares.back(), 1);
  const auto profile = upscaler.profile();
  const auto count = [&](const std::string& name) {
    return std::count_if(profile.begin(), profile.end(), [&](const auto& row) { return row.label == name; });
  };
  EXPECT_EQ(count("add_excess"), 1);
  EXPECT_EQ(count("binned_exposure"), 1);
  EXPECT_GE(count("decode_frame"), 3);
  EXPECT_FALSE(upscaler.run(viewOf(colour_, 1), views, output, [](double) { return false; }));
  EXPECT_TRUE(upscaler.run(viewOf(colour_, 1), views, output));
}

// In the least memory in which it goes at all they find no room in front of the upscaler.
TEST_F(Denoising, NeedsLessRoomOneAfterTheOther) {
  const Pixels expected = through(guided_, colour_, 1, {&albedo_, &normal_},
                                  {.denoisers = {&colourNetwork_, &albedoNetwork_, &normalNetwork_, true}});
  const PixelView views[] = {viewOf(albedo_, kScale), viewOf(normal_, kScale)};
  Pixels found(albedo_.size());
  const auto optionsIn = [&](uint64_t memory) {
    return Upscaler::Options{.profile = true, .tiles = {.memoryBytes = memory, .exact = true}, .denoisers = denoisers_};
  };
  const auto denoisesAlone = [&](uint64_t memory) {
    Upscaler upscaler(device(), guided_, kWidth, kHeight, optionsIn(memory));
    EXPECT_TRUE(upscaler.run(viewOf(colour_, 1), views, found));
    const auto rows = upscaler.profile();
    return std::none_of(rows.begin(), rows.end(), [](const auto& row) { return row.label == "add_excess"; });
  };
  uint64_t bytes = 100000;
  const auto isRefused = [&] {
    try {
      Upscaler(device(), guided_, kWidth, kHeight, optionsIn(bytes));
      return false;
    } catch (const OutOfMemory&) {
      return true;
    }
  };
  while (isRefused()) bytes += bytes / 8;
  EXPECT_TRUE(denoisesAlone(bytes)) << bytes;
  EXPECT_EQ(found, expected);
  EXPECT_FALSE(denoisesAlone(uint64_t{1} << 30));
}

TEST_F(Denoising, CanBeStoppedOneAfterTheOther) {
  Upscaler upscaler(device(), guided_, kWidth, kHeight, {.ensemble = 2, .denoisers = denoisers_});
  const PixelView views[] = {viewOf(albedo_, kScale), viewOf(normal_, kScale)};
  Pixels outputs[2] = {Pixels(albedo_.size()), Pixels(albedo_.size())};
  ASSERT_TRUE(upscaler.run(viewOf(colour_, 1), views, outputs[0]));
  for (const double end : {0.0, 0.3, 0.9})
    EXPECT_FALSE(upscaler.run(viewOf(colour_, 1), views, outputs[1], [&](double share) { return share < end; })) << end;
  ASSERT_TRUE(upscaler.run(viewOf(colour_, 1), views, outputs[1]));
  EXPECT_EQ(outputs[0], outputs[1]);
}

TEST_F(Denoising, RefusesWhatItCannotDo) {
  const PixelView views[] = {viewOf(albedo_, kScale), viewOf(normal_, kScale)};
  const auto messageOf = [](const auto& action) {
    try {
      action();
    } catch (const InvalidArgument& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  const auto refusal = [&](const Upscaler::Options& options, const Model& model) {
    const std::span images = std::span(views).first(model.auxiliaryInputs().size());
    const std::string message = messageOf([&] { Upscaler(device(), model, kWidth, kHeight, options); });
    const std::string ofCheck =
        messageOf([&] { Upscaler::check(device(), model, viewOf(colour_, 1), images, options); });
    EXPECT_EQ(ofCheck, message);
    return message;
  };
  const auto has = [](const std::string& message, const char* word) {
    EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
  };
  has(refusal({.denoisers = {.albedo = &albedoNetwork_}}, guided_), "without one of the colour");
  has(refusal({.denoisers = {.colour = &albedoNetwork_}}, guided_), "HDR");
  has(refusal({.denoisers = {.colour = &guided_}}, guided_), "HDR");
  has(refusal({.denoisers = {&colourNetwork_, &normalNetwork_, nullptr}}, guided_), "albedo");
  has(refusal({.denoisers = {&colourNetwork_, nullptr, &albedoNetwork_}}, guided_), "normal");
  has(refusal({.denoisers = denoisers_}, golden("s1_none_noaux")), "does not take");
  const Upscaler::Options narrow{.tiles = {.memoryBytes = 100000}, .denoisers = denoisers_};
  EXPECT_THROW(Upscaler(device(), guided_, kWidth, kHeight, narrow), OutOfMemory);
}

}  // namespace
}  // namespace xrds
