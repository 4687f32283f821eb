#include "xrds/relative_depth.h"

#include <gtest/gtest.h>

#include <limits>

namespace xrds {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(RelativeDepth, IsOneHalfAtTheMedianAndItsQuarterAndFourfold) {
  const auto relative = relativeDepth(std::vector<float>{2, 8, 32});
  ASSERT_EQ(relative.size(), 9U);
  EXPECT_FLOAT_EQ(relative[0], 0.5F);  // 2 / (2 + 8 / 4)
  EXPECT_FLOAT_EQ(relative[3 + 1], 0.5F);
  EXPECT_FLOAT_EQ(relative[6 + 2], 0.5F);
  EXPECT_FLOAT_EQ(relative[1], 0.2F);
  EXPECT_FLOAT_EQ(relative[3 + 2], 0.2F);
}

TEST(RelativeDepth, DoesNotDependOnTheUnit) {
  const auto metres = relativeDepth(std::vector<float>{1, 3, 4, 10});
  const auto millimetres = relativeDepth(std::vector<float>{1e3F, 3e3F, 4e3F, 1e4F});
  for (size_t i = 0; i < metres.size(); ++i) EXPECT_FLOAT_EQ(metres[i], millimetres[i]);
}

TEST(RelativeDepth, TakesTheLowerMedian) { EXPECT_FLOAT_EQ(relativeDepth(std::vector<float>{3, 1, 10, 4})[1], 0.5F); }

TEST(RelativeDepth, BackgroundIsOneAndDoesNotCount) {
  const std::vector<float> background{0, -1, kInfinity, std::numeric_limits<float>::quiet_NaN(), 1e10F, 1e8F};
  std::vector<float> distances = background;
  distances.push_back(5);
  const auto relative = relativeDepth(distances);
  for (size_t i = 0; i < 3 * background.size(); ++i) EXPECT_EQ(relative[i], 1) << i;
  EXPECT_FLOAT_EQ(relative[3 * background.size() + 1], 0.5F);
}

TEST(RelativeDepth, OfNothingButBackgroundIsOne) {
  for (const float value : relativeDepth(std::vector<float>{0, kInfinity})) EXPECT_EQ(value, 1);
}

}  // namespace
}  // namespace xrds
