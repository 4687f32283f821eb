#include "viewer/view_state.h"

#include <gtest/gtest.h>

namespace xrds {
namespace {

Viewport fitted(double areaWidth, double areaHeight, double width, double height) {
  Viewport viewport;
  viewport.resize(areaWidth, areaHeight, width, height);
  return viewport;
}

TEST(Viewport, FitsLargePicturesByTheTighterSideAndSmallOnesByWholeFactors) {
  EXPECT_DOUBLE_EQ(fitted(400, 300, 1600, 600).zoom, 0.25);
  EXPECT_DOUBLE_EQ(fitted(400, 300, 100, 140).zoom, 2);
  const Viewport viewport = fitted(400, 300, 100, 140);
  EXPECT_DOUBLE_EQ(viewport.left, 100);
  EXPECT_DOUBLE_EQ(viewport.top, 10);
}

TEST(Viewport, KeepsThePixelUnderTheCursorWhenZooming) {
  Viewport viewport = fitted(400, 300, 320, 240);
  for (const int direction : {1, 1, 1, -1, 1, 1}) {
    const double x = (123 - viewport.left) / viewport.zoom, y = (77 - viewport.top) / viewport.zoom;
    viewport.zoomAbout(123, 77, viewport.zoomStep(direction));
    EXPECT_NEAR((123 - viewport.left) / viewport.zoom, x, 0.51 / viewport.zoom);
    EXPECT_NEAR((77 - viewport.top) / viewport.zoom, y, 0.51 / viewport.zoom);
  }
  EXPECT_FALSE(viewport.fitted);
}

TEST(Viewport, StepsThroughWholeNumbersAboveOne) {
  Viewport viewport = fitted(400, 300, 320, 240);
  std::vector<double> steps;
  for (int i = 0; i < 5; ++i) viewport.zoomAbout(0, 0, viewport.zoomStep(1)), steps.push_back(viewport.zoom);
  EXPECT_EQ(steps, (std::vector<double>{2, 3, 4, 6, 8}));
  for (int i = 0; i < 5; ++i) viewport.zoomAbout(0, 0, viewport.zoomStep(-1));
  EXPECT_DOUBLE_EQ(viewport.zoom, 1);
  viewport.zoomAbout(0, 0, 1e9);
  EXPECT_DOUBLE_EQ(viewport.zoom, 128);
}

TEST(Viewport, NeverLosesThePicture) {
  Viewport viewport = fitted(400, 300, 320, 240);
  viewport.pan(1e6, -1e6);
  EXPECT_DOUBLE_EQ(viewport.left, 400 - 32);
  EXPECT_DOUBLE_EQ(viewport.top, 32 - 240);
}

TEST(Viewport, KeepsTheMiddleWhenTheWindowGrows) {
  Viewport viewport = fitted(400, 300, 320, 240);
  viewport.zoomAbout(200, 150, 4);
  viewport.pan(-60, 30);
  const double x = viewport.pictureX(200), y = viewport.pictureY(150);
  viewport.resize(800, 500, 320, 240);
  EXPECT_EQ(viewport.pictureX(400), x);
  EXPECT_EQ(viewport.pictureY(250), y);
  viewport.fit();
  viewport.resize(400, 300, 320, 240);  // a fitted picture stays fitted
  EXPECT_DOUBLE_EQ(viewport.zoom, 1);
}

TEST(Viewport, NamesThePixelUnderAPoint) {
  const Viewport viewport = fitted(400, 300, 320, 240);  // from (40, 30) on
  EXPECT_TRUE(viewport.contains(40, 30));
  EXPECT_FALSE(viewport.contains(39.9, 30));
  EXPECT_TRUE(viewport.contains(359.9, 269.9));
  EXPECT_FALSE(viewport.contains(360, 100));
  EXPECT_EQ(viewport.pictureX(41.7), 1);
}

TEST(ViewState, TheDividerLiesOnThePicture) {
  ViewState state;
  state.viewport = fitted(400, 300, 320, 240);
  state.wipe = 0.25;
  EXPECT_DOUBLE_EQ(state.divider(), 120);
  state.stops = 3;
  EXPECT_FLOAT_EQ(state.exposure(), 8);
}

}  // namespace
}  // namespace xrds
