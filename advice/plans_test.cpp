#include "advice/plans.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace xrds {
namespace {

constexpr size_t kPixels = 16000;
constexpr RenderCost kCost{1, 0.001};  // 17 s for one sample of the frame
const SceneFeatures kScene{-2, -8, -6};

Way way(const std::string& model, int scale) {
  return {.name = model,
          .model = model,
          .scale = scale,
          .ratios = {16},
          .constant = 20,
          .perNoise = -1,
          .leastNoise = -100,
          .mostNoise = 0};
}

TEST(Plans, TakeTheSecondsOfRendersDenoiserAndNetwork) {
  Way full = way("full", 4);
  full.merges = full.denoisesFirst = full.takesFullColour = true;
  const StepSeconds steps{.models = {{"full", 2}}, .denoiser = 0.8};
  const std::vector<Plan> plans = plansOf(kScene, {full}, kCost, steps, kPixels);
  ASSERT_FALSE(plans.empty());
  const Plan& quickest = plans.front();  // 16 samples of a sixteenth of the pixels, and 1 of all
  EXPECT_EQ(quickest.samples.low, 16);
  EXPECT_EQ(quickest.samples.full, 1);
  EXPECT_DOUBLE_EQ(quickest.renderSeconds, 17 + 17);
  EXPECT_DOUBLE_EQ(quickest.afterSeconds, 2 + 0.8 * 49 / 48);  // two colours, albedo and normal denoised
  EXPECT_DOUBLE_EQ(quickest.psnr, 20 + 2 + 5);                 // 32 samples are left of the noise
}

TEST(Plans, LeaveOutWhatTheUserCannotDo) {
  Way denoiser = way("", 1), free = way("free", 4);
  free.guides = Guides::free;
  const StepSeconds none{.models = {{"free", 1}}};
  EXPECT_TRUE(plansOf(kScene, {denoiser, free, way("absent", 4)}, kCost, none, kPixels).empty());
  const StepSeconds all{.models = {{"free", 1}, {"absent", 1}}, .denoiser = 1, .freeGuides = 3};
  const std::vector<Plan> plans = plansOf(kScene, {denoiser, free, way("absent", 4)}, kCost, all, kPixels);
  const auto of = [&](const std::string& name) {
    return std::find_if(plans.begin(), plans.end(), [&](const Plan& plan) { return plan.way.name == name; });
  };
  ASSERT_NE(of(""), plans.end());
  EXPECT_DOUBLE_EQ(of("")->seconds(), 17 + 1);
  ASSERT_NE(of("free"), plans.end());
  EXPECT_EQ(of("free")->samples.full, 0);
  EXPECT_DOUBLE_EQ(of("free")->renderSeconds, 2 + 3);
  EXPECT_NE(of("absent"), plans.end());
}

TEST(Plans, StayWithinTwiceWhatWasMeasured) {
  Way measured = way("", 1);
  measured.leastNoise = -6;  // 16 samples
  measured.mostNoise = -4;   // 4
  std::vector<double> counts;
  for (const Plan& plan : plansOf(kScene, {measured}, kCost, {.denoiser = 1}, kPixels))
    counts.push_back(plan.samples.full);
  EXPECT_EQ(counts, (std::vector<double>{2, 4, 8, 16, 32}));
}

TEST(Plans, TheBestIsChosenForATimeOrAnError) {
  std::vector<Plan> plans;
  for (const auto& [seconds, psnr] : {std::pair{1.0, 20.0}, {2.0, 24.0}, {3.0, 22.0}, {4.0, 30.0}})
    plans.push_back({.renderSeconds = seconds, .psnr = psnr});
  EXPECT_EQ(worthwhile(plans).size(), 3U);
  EXPECT_EQ(bestWithin(plans, 3.5)->psnr, 24);
  EXPECT_EQ(bestWithin(plans, 4)->psnr, 30);
  EXPECT_FALSE(bestWithin(plans, 0.5));
  EXPECT_EQ(quickestReaching(plans, 21)->seconds(), 2);
  EXPECT_FALSE(quickestReaching(plans, 31));
}

}  // namespace
}  // namespace xrds
