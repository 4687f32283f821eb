#include "viewer/upscaling/stage_times.h"

#include <gtest/gtest.h>

namespace xrds {
namespace {

using namespace std::chrono_literals;

TEST(StageTimes, AddUpToTheTotalAndPartsToTheNetwork) {
  StageClock clock;
  auto now = StageClock::Clock::time_point{} + 1h;
  clock.begin(now);
  clock.end("read files", now += 30ms);
  clock.end("copies", now += 5ms);
  clock.end(kNetworkStage, now += 100ms);
  clock.end("copies", now += 2ms);
  const std::vector<Upscaler::ProfileRow> rows{{.label = "aux_conv", .microseconds = 20000},
                                               {.label = "groups.0.a", .microseconds = 60000},
                                               {.label = "up.0", .microseconds = 15000}};
  const std::vector<StageTime> times = stageTimes(clock.steps(), rows);
  double steps = 0, parts = 0;
  for (const StageTime& time : times)
    if (time.name != kTotalStage) (time.isPart ? parts : steps) += time.milliseconds;
  ASSERT_EQ(times.back().name, kTotalStage);
  EXPECT_NEAR(times.back().milliseconds, 137, 1e-9);
  EXPECT_NEAR(steps, times.back().milliseconds, 1e-9);
  EXPECT_NEAR(parts, 100, 1e-9);
  EXPECT_NEAR(times[1].milliseconds, 7, 1e-9) << "copies before and after the network are one row";
}

TEST(StageTimes, DenoisersAreAPartOfTheirOwn) {
  const std::vector<StageTime> parts = networkParts({{.label = "enc_conv0", .microseconds = 3000},
                                                     {.label = "up.0", .microseconds = 1000},
                                                     {.label = "dec_conv4a", .microseconds = 4000}});
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[1].name, "denoisers");
  EXPECT_NEAR(parts[1].milliseconds, 7, 1e-9);
}

TEST(StageTimes, WithoutTimestampsTheNetworkHasNoParts) {
  StageClock clock;
  auto now = StageClock::Clock::time_point{} + 1h;
  clock.begin(now);
  clock.end(kNetworkStage, now += 40ms);
  const std::vector<StageTime> times = stageTimes(clock.steps(), {});
  ASSERT_EQ(times.size(), 2u);
  EXPECT_NEAR(times[1].milliseconds, 40, 1e-9);
}

TEST(StageClock, ForgetsWhatCameBefore) {
  StageClock clock;
  auto now = StageClock::Clock::time_point{} + 1h;
  clock.begin(now);
  clock.end("read files", now += 30ms);
  clock.begin(now += 500ms);
  clock.end(kNetworkStage, now += 10ms);
  ASSERT_EQ(clock.steps().size(), 1u);
  EXPECT_NEAR(clock.steps()[0].milliseconds, 10, 1e-9);
}

}  // namespace
}  // namespace xrds
