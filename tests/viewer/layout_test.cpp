#include "viewer/display/layout.h"

#include <gtest/gtest.h>

namespace xrds {
namespace {

bool overlap(const Area& a, const Area& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

TEST(Layout, LabelsNeverOverlapNorLeaveThePicture) {
  constexpr float kHeight = 200, kRim = 8;
  for (float width = 40; width < 1300; width += 7)
    for (const float left : {30.F, 170.F, 420.F})
      for (const float right : {30.F, 250.F, 900.F}) {
        const auto areas = placeInCorners(width, kHeight, {0, 0, left, 20}, {0, 0, right, 52}, kRim);
        EXPECT_FALSE(overlap(areas[0], areas[1])) << width << " " << left << " " << right;
        for (const Area& area : areas) {
          EXPECT_GE(area.x, 0);
          EXPECT_LE(area.x + area.width, width - kRim + 0.01F);
          EXPECT_LE(area.y + area.height, kHeight - kRim);
        }
      }
}

TEST(Layout, LabelsStandInTheCornersWhereTheyFit) {
  const auto areas = placeInCorners(400, 300, {0, 0, 100, 20}, {0, 0, 120, 50}, 8);
  EXPECT_FLOAT_EQ(areas[0].x, 8);
  EXPECT_FLOAT_EQ(areas[0].y, 300 - 8 - 20);
  EXPECT_FLOAT_EQ(areas[1].x, 400 - 8 - 120);
  EXPECT_FLOAT_EQ(areas[1].y, 300 - 8 - 50);
}

TEST(Layout, ALabelThatIsNotThereTakesNoPlace) {
  const auto areas = placeInCorners(200, 300, {}, {0, 0, 500, 20}, 8);
  EXPECT_FLOAT_EQ(areas[1].x, 8);
  EXPECT_FLOAT_EQ(areas[1].width, 200 - 16);
}

TEST(Layout, ThePanelFoldsWhereLittleWouldBeLeft) {
  EXPECT_EQ(panelPlace(true, false, 1280), PanelPlace::beside);
  EXPECT_EQ(panelPlace(true, false, 800), PanelPlace::beside);
  EXPECT_EQ(panelPlace(true, false, 480), PanelPlace::folded);
  EXPECT_EQ(panelPlace(true, true, 320), PanelPlace::over);
  EXPECT_EQ(panelPlace(true, true, 800), PanelPlace::beside);
  EXPECT_EQ(panelPlace(false, true, 320), PanelPlace::hidden);
}

}  // namespace
}  // namespace xrds
