#include "frames/ensemble.h"

#include <gtest/gtest.h>

#include <cmath>

namespace xrds {
namespace {

// Two rows of three pixels of four floats: (x, y, 7) and something else.
constexpr float kPixels[] = {0, 1, 7, -1, 1, 1, 7, -1, 2, 1, 7, -1, 0, 2, 7, -1, 1, 2, 7, -1, 2, 2, 7, -1};
constexpr PixelView kImage{kPixels, 3, 2, 4};

TEST(Ensemble, TheMeanOfMirroredResultsIsTheResult) {
  const std::vector<float> picture = mirrored(kImage, {}, false);
  for (const Transfer transfer : {Transfer::none, Transfer::log1p}) {
    EnsembleMean mean(3, 2, transfer);
    for (const Mirror mirror : mirrorsOf(8)) mean.add(mirrored(kImage, mirror, false), mirror, 0.5f);
    std::vector<float> output(18);
    mean.write(output, 0.5f);
    for (size_t i = 0; i < output.size(); ++i) EXPECT_NEAR(output[i], picture[i], 1e-5);
  }
}

TEST(Ensemble, ABrightPixelOfOnePassWeighsLittle) {
  EnsembleMean mean(1, 1, Transfer::log1p);
  for (const float value : {1e6f, 1.f, 1.f, 1.f}) mean.add(std::vector<float>(3, value), {}, 2);
  std::vector<float> output(3);
  mean.write(output, 2);
  EXPECT_NEAR(output[0], (std::pow(2e6 + 1, 0.25) * std::pow(3, 0.75) - 1) / 2, 0.01);
}

}  // namespace
}  // namespace xrds
