#include "image/frame_fit.h"

#include <gtest/gtest.h>

#include "xrds/error.h"

namespace xrds {
namespace {

ExrPart partOf(const Box& dataWindow, const Box& displayWindow) {
  ExrPart part;
  part.dataWindow = dataWindow;
  part.displayWindow = displayWindow;
  return part;
}

constexpr Box kLow{0, 0, 63, 47};
constexpr Box kHigh{0, 0, 255, 191};

TEST(FrameFit, SeparateFilesFitByTheirDisplayWindows) {
  EXPECT_EQ(fitFrame(partOf(kLow, kLow), partOf(kHigh, kHigh)), (FrameFit{4, kHigh, kHigh}));
}

TEST(FrameFit, OverscanAndCropsAreScaledWithTheColor) {
  const FrameFit fit = fitFrame(partOf({-2, -2, 65, 49}, kLow), partOf({5, 5, 100, 100}, kHigh));
  EXPECT_EQ(fit, (FrameFit{4, {-8, -8, 263, 199}, kHigh}));
}

TEST(FrameFit, PartsOfOneFileFitByTheirSizes) {
  EXPECT_EQ(fitFrame(partOf(kLow, kHigh), partOf(kHigh, kHigh)), (FrameFit{4, kHigh, kHigh}));
  EXPECT_EQ(fitFrame(partOf(kLow, kLow), partOf(kHigh, kLow)), (FrameFit{4, kHigh, kHigh}));
}

TEST(FrameFit, EqualSizesHaveScaleOne) {
  EXPECT_EQ(fitFrame(partOf(kLow, kLow), partOf(kLow, kLow)), (FrameFit{1, kLow, kLow}));
  EXPECT_EQ(fitFrame(partOf({3, 3, 20, 20}, kLow), partOf(kLow, kLow)), (FrameFit{1, {3, 3, 20, 20}, kLow}));
}

TEST(FrameFit, RefusesWhatIsNoWholeMultiple) {
  EXPECT_THROW(static_cast<void>(fitFrame(partOf(kLow, kLow), partOf({0, 0, 99, 99}, {0, 0, 99, 99}))), Error);
  EXPECT_THROW(static_cast<void>(fitFrame(partOf(kHigh, kHigh), partOf(kLow, kLow))), Error);
}

}  // namespace
}  // namespace xrds
