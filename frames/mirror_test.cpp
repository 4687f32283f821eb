#include "xrds/mirror.h"

#include <gtest/gtest.h>

#include "xrds/error.h"

namespace xrds {
namespace {

// Two rows of three pixels of four floats: (x, y, 7) and something else.
constexpr float kPixels[] = {0, 1, 7, -1, 1, 1, 7, -1, 2, 1, 7, -1, 0, 2, 7, -1, 1, 2, 7, -1, 2, 2, 7, -1};
constexpr PixelView kImage{kPixels, 3, 2, 4};

TEST(Mirror, EndsWithTheFrameAsItIs) {
  for (const uint32_t passes : {1u, 2u, 4u, 8u}) {
    const auto mirrors = mirrorsOf(passes);
    EXPECT_EQ(mirrors.size(), passes);
    EXPECT_FALSE(mirrors.back().leftRight || mirrors.back().upsideDown || mirrors.back().transposed);
  }
  EXPECT_TRUE(mirrorsOf(2)[0].leftRight && mirrorsOf(2)[0].upsideDown);
  for (const uint32_t passes : {0u, 3u, 16u}) EXPECT_THROW(mirrorsOf(passes), Error);
}

TEST(Mirror, MirrorsPixelsAndTurnsNormalsAlong) {
  const std::vector<float> flipped = mirrored(kImage, {.leftRight = true}, false);
  EXPECT_EQ(flipped, (std::vector<float>{2, 1, 7, 1, 1, 7, 0, 1, 7, 2, 2, 7, 1, 2, 7, 0, 2, 7}));
  const std::vector<float> turned = mirrored(kImage, {true, true}, true);
  EXPECT_EQ(turned, (std::vector<float>{-2, -2, 7, -1, -2, 7, 0, -2, 7, -2, -1, 7, -1, -1, 7, 0, -1, 7}));
  EXPECT_EQ(mirrored(kImage, {.upsideDown = true}, true)[1], -2);
  const std::vector<float> transposed = mirrored(kImage, {.transposed = true}, false);
  EXPECT_EQ(transposed, (std::vector<float>{0, 1, 7, 0, 2, 7, 1, 1, 7, 1, 2, 7, 2, 1, 7, 2, 2, 7}));
  // What pointed up points left.
  const float up[] = {0, 1, 0};
  EXPECT_EQ(mirrored({up, 1, 1}, {.transposed = true}, true), (std::vector<float>{-1, 0, 0}));
  EXPECT_EQ(mirrored({up, 1, 1}, {true, false, true}, true), (std::vector<float>{1, 0, 0}));
}

TEST(Mirror, MirrorsTakeEachPixelBack) {
  for (const Mirror mirror : mirrorsOf(4))
    for (uint64_t p = 0; p < 6; ++p) EXPECT_EQ(mirroredPixel(mirroredPixel(p, 3, 2, mirror), 3, 2, mirror), p);
  EXPECT_EQ(mirroredPixel(1, 3, 2, {.upsideDown = true}), 4u);
  EXPECT_EQ(mirroredPixel(1, 2, 3, {.transposed = true}), 3u);  // (1, 0) is (0, 1) of 3 x 2
  EXPECT_EQ(mirroredPixel(1, 2, 3, {true, false, true}), 0u);
}

}  // namespace
}  // namespace xrds
