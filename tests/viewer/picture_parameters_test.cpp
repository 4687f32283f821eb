#include "viewer/display/picture_parameters.h"

#include <gtest/gtest.h>

#include "image/metrics/metrics.h"

namespace xrds {
namespace {

TEST(PictureParameters, TheErrorOfAPixelIsThatOfTheMetrics) {
  Image found(1, 1, 3), expected(1, 1, 3);
  found.pixels = {0.5F, 0.25F, 3};
  expected.pixels = {0.4F, 0, 7};
  float mean = 0;
  for (size_t c = 0; c < 3; ++c) mean += shader::relativeSquaredError(found.pixels[c], expected.pixels[c]) / 3;
  EXPECT_NEAR(mean, relMseMap(found, expected).pixels[0], 1e-6F * mean);
  EXPECT_EQ(shader::relativeSquaredError(0.3F, 0.3F), 0);
}

}  // namespace
}  // namespace xrds
