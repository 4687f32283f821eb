#include "image/png_write.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "image/compose.h"
#include "tests/temporary_folder.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using test::TemporaryFolder;

struct Png {
  int width = 0;
  int height = 0;
  png_uint_32 format = 0;
  std::vector<uint8_t> bytes;
};

Png readPng(const std::filesystem::path& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&image, path.string().c_str()), 0);
  Png result{static_cast<int>(image.width), static_cast<int>(image.height), image.format, {}};
  result.bytes.resize(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, result.bytes.data(), 0, nullptr), 0);
  return result;
}

TEST(Png, AppliesTheSrgbCurve) {
  const TemporaryFolder folder;
  Image image(3, 1, 3);
  image.pixels = {0.0F,      1.0F, 0.5F, 0.0031308F, 0.18F, 2.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(),
                  0.2158605F};
  writePng(folder / "a.png", image);
  const Png png = readPng(folder / "a.png");
  EXPECT_EQ(png.width, 3);
  EXPECT_EQ(png.height, 1);
  EXPECT_EQ(png.bytes, (std::vector<uint8_t>{0, 255, 188, 10, 118, 255, 0, 0, 128}));
  EXPECT_EQ(folder.fileCount(), 1U);
}

TEST(Png, AppliesExposureButNotToAlpha) {
  const TemporaryFolder folder;
  Image image(1, 1, 4);
  image.pixels = {0.25F, 0.25F, 0.5F, 0.5F};
  writePng(folder / "a.png", image, 2.0F);
  const Png png = readPng(folder / "a.png");
  EXPECT_EQ(png.bytes, (std::vector<uint8_t>{188, 188, 255, 128}));
}

TEST(Png, WritesGrey) {
  const TemporaryFolder folder;
  Image image(2, 2, 1, 0.5F);
  writePng(folder / "a.png", image);
  EXPECT_EQ(readPng(folder / "a.png").bytes, std::vector<uint8_t>(4, 188));
}

TEST(Png, RefusesWhatItCannotWrite) {
  const TemporaryFolder folder;
  EXPECT_THROW(writePng(folder / "a.png", Image(2, 2, 2)), Error);
  EXPECT_THROW(writePng(folder / "a.png", Image()), Error);
  EXPECT_THROW(writePng(folder / "absent" / "a.png", Image(2, 2, 3)), Error);
#ifndef _WIN32
  EXPECT_THROW(writePng("/dev/full", Image(2, 2, 3)), Error);
  EXPECT_THROW(writePng("/proc/self/a.png", Image(2, 2, 3)), Error);
#endif
  EXPECT_EQ(folder.fileCount(), 0U);
}

TEST(Compose, EnlargesByRepeating) {
  Image image(2, 1, 2);
  image.pixels = {1, 2, 3, 4};
  EXPECT_EQ(enlargeNearest(image, 2).pixels, (std::vector<float>{1, 2, 1, 2, 3, 4, 3, 4, 1, 2, 1, 2, 3, 4, 3, 4}));
  EXPECT_EQ(enlargeNearest(image, 1), image);
  EXPECT_THROW(static_cast<void>(enlargeNearest(image, 0)), Error);
}

TEST(Compose, PutsImagesSideBySide) {
  Image left(1, 2, 1, 3.0F);
  Image right(2, 2, 1, 5.0F);
  const Image both = sideBySide({left, right}, 1);
  EXPECT_EQ(both.width, 4);
  EXPECT_EQ(both.pixels, (std::vector<float>{3, 0, 5, 5, 3, 0, 5, 5}));
  EXPECT_EQ(sideBySide({left}), left);
  EXPECT_THROW(static_cast<void>(sideBySide({left, Image(1, 3, 1)})), Error);
  EXPECT_THROW(static_cast<void>(sideBySide({left, Image(1, 2, 3)})), Error);
  EXPECT_THROW(static_cast<void>(sideBySide({})), Error);
}

TEST(Compose, HeatGrowsBrighterWithTheError) {
  Image error(6, 1, 1);
  error.pixels = {0.0F, 0.25F, 0.5F, 0.75F, 1.0F, 9.0F};
  const Image heat = heatMap(error, 1.0F);
  const auto brightness = [&](int x) {
    return 0.2126F * heat.at(x, 0, 0) + 0.7152F * heat.at(x, 0, 1) + 0.0722F * heat.at(x, 0, 2);
  };
  for (int x = 1; x < 5; ++x) {
    EXPECT_GT(brightness(x), brightness(x - 1));
  }
  EXPECT_EQ(brightness(5), brightness(4));
  EXPECT_THROW(static_cast<void>(heatMap(error, 0.0F)), Error);
  EXPECT_THROW(static_cast<void>(heatMap(Image(1, 1, 3), 1.0F)), Error);
  error.pixels[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(heatMap(error, 1.0F).at(0, 0, 1), 0.0F);
}

}  // namespace
}  // namespace xrds
