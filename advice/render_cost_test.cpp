#include "advice/render_cost.h"

#include <gtest/gtest.h>

#include "xrds/error.h"

namespace xrds {
namespace {

TEST(RenderCost, LiesOnBothRenders) {
  const RenderCost cost = renderCost({5, 4, 1000}, {8, 1, 16000});
  EXPECT_DOUBLE_EQ(cost.perSample, 0.00025);
  EXPECT_DOUBLE_EQ(cost.start, 4);
  EXPECT_DOUBLE_EQ(cost.seconds(1, 16000), 8);
}

TEST(RenderCost, IsTheMeanWhereTheRendersContradictEachOther) {
  for (const RenderCost& cost : {renderCost({3, 1, 1000}, {1, 1, 3000}), renderCost({1, 1, 2000}, {5, 2, 2000})}) {
    EXPECT_EQ(cost.start, 0);
    EXPECT_DOUBLE_EQ(cost.perSample, 0.001);
  }
}

TEST(RenderCost, NeedsPositiveNumbers) {
  EXPECT_THROW(renderCost({0, 1, 10}, {1, 1, 20}), Error);
  EXPECT_THROW(renderCost({1, 1, 10}, {1, 0, 20}), Error);
  EXPECT_THROW(renderCost({1, 1, 0}, {1, 1, 20}), Error);
}

TEST(RenderCost, DurationsAreReadAsCyclesWritesThem) {
  EXPECT_EQ(parseDuration("1.5"), 1.5);
  EXPECT_EQ(parseDuration("02:01.5"), 121.5);
  EXPECT_EQ(parseDuration("1:02:03"), 3723);
  for (const char* text : {"", ":", "1:", "1:2:3:4", "-1", "1.5s", "abc"}) EXPECT_FALSE(parseDuration(text)) << text;
}

}  // namespace
}  // namespace xrds
