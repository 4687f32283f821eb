#include "engine/pace.h"

#include <gtest/gtest.h>

namespace xrds {
namespace {

constexpr uint64_t kMost = uint64_t{16} << 30;

TEST(Pace, AnUnknownDeviceGetsWorkFor100GflopsWithin100Milliseconds) {
  EXPECT_LE(static_cast<double>(workOfSubmission({}, kMost)), 0.1 * 50e9);
  EXPECT_EQ(workOfSubmission({}, 1000), 1000u);
}

TEST(Pace, AMeasuredDeviceGetsWhatItDoesInTheTime) {
  for (const double pace : {1e9, 5e10, 1e11}) {
    const double seconds = static_cast<double>(workOfSubmission({2 * pace, pace}, kMost)) / pace;
    EXPECT_NEAR(seconds, kSubmissionSeconds, 1e-3) << pace;
  }
  EXPECT_EQ(workOfSubmission({1e14, 1e14}, kMost), kMost);
  EXPECT_GT(workOfSubmission({1, 1}, kMost), 1000u) << "never nothing";
}

TEST(Pace, RunsTooShortTellNothing) {
  const Pace before{5e9, 1e9};
  EXPECT_EQ(measured(before, 1e6, 1e-4, 1e10).slowest, before.slowest);
  EXPECT_EQ(measured(before, 1e9, 1, 0).slowest, before.slowest);
  EXPECT_EQ(measured(before, 1e9, 0.5, 1e9).mean, 2e9);
}

}  // namespace
}  // namespace xrds
