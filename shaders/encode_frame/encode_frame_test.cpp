#include "shaders/encode_frame/encode_frame.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::encode_frame_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, paddedHeight, paddedWidth, guides;
  RowRange rows{};
};

constexpr Shape kShapes[] = {{1, 1, 16, 16, 0},         {9, 13, 16, 16, 1},           {16, 16, 16, 16, 2},
                             {5, 7, 16, 32, 2, {3, 6}}, {17, 33, 32, 48, 0, {8, 32}}, {17, 33, 32, 48, 2, {16, 20}}};

EncodeFrame encodeOf(const Shape& s, FrameCurve curve, DataType outputType = DataType::f32) {
  const uint32_t channels = 4 + 4 * s.guides;
  EncodeFrame op{.input = view(0, DataType::f32, s.height, s.width, 4), .curve = curve, .rows = s.rows};
  if (s.guides > 0) op.guides = view(1, DataType::f32, s.height, s.width, 4 * s.guides);
  if (curve == FrameCurve::hdr) op.exposure = view(2, DataType::f32, 1, 1, 4);
  op.output = view(3, outputType, s.paddedHeight, s.paddedWidth, channels, 4, channels + 8);
  return op;
}

class EncodeFrameShapes : public testing::TestWithParam<std::tuple<Shape, KernelFamily, FrameCurve, DataType>> {};

// Radiance of all magnitudes, so that each part of the curve is met; some below zero.
TEST_P(EncodeFrameShapes, MatchesReference) {
  const auto& [s, family, curve, outputType] = GetParam();
  const EncodeFrame op = encodeOf(s, curve, outputType);
  std::vector<float> pixels = test::randomNumbers(op.input.storedElementCount(), 5);
  if (curve == FrameCurve::hdr)
    for (size_t i = 0; i < pixels.size(); ++i) pixels[i] *= std::pow(10.f, static_cast<float>(i % 14) - 8);
  test::expectMatchesReference(op, test::traitsOf(family), test::toleranceOf(outputType),
                               {{0, pixels}, {2, {0.7f, 1 / 0.7f, 0, 0}}});
}

INSTANTIATE_TEST_SUITE_P(All, EncodeFrameShapes,
                         testing::Combine(testing::ValuesIn(kShapes),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane),
                                          testing::Values(FrameCurve::hdr, FrameCurve::ldr, FrameCurve::normal),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(FrameCurve, EndsAtZeroAndOneAndIsInverted) {
  EXPECT_NEAR(curved(FrameCurve::hdr, 65504), 1, 1e-7);
  EXPECT_NEAR(curved(FrameCurve::ldr, 1), 1, 1e-7);
  EXPECT_EQ(curved(FrameCurve::normal, -1), 0);
  for (const FrameCurve curve : {FrameCurve::hdr, FrameCurve::ldr}) EXPECT_EQ(curved(curve, -3), 0);
  EXPECT_EQ(curved(FrameCurve::hdr, std::numeric_limits<double>::quiet_NaN()), 0);
  for (const double value : {1e-7, 1e-5, 0.01, 0.18, 0.5, 0.99}) {
    EXPECT_NEAR(uncurved(FrameCurve::hdr, curved(FrameCurve::hdr, value)) / value, 1, 1e-4);
    EXPECT_NEAR(uncurved(FrameCurve::ldr, curved(FrameCurve::ldr, value)) / value, 1, 1e-4);
    EXPECT_NEAR(uncurved(FrameCurve::normal, curved(FrameCurve::normal, -value)), -value, 1e-12);
  }
  EXPECT_NEAR(uncurved(FrameCurve::hdr, 1) / 65504, 1, 1e-4);
}

TEST(EncodeFrame, RefusesWhatDoesNotFit) {
  EncodeFrame op = encodeOf({4, 4, 16, 16, 2}, FrameCurve::hdr);
  op.guides = view(1, DataType::f32, 4, 5, 8);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = encodeOf({4, 4, 16, 16, 2}, FrameCurve::hdr);
  op.output = view(3, DataType::f32, 16, 16, 8);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = encodeOf({4, 4, 16, 16, 0}, FrameCurve::hdr);
  op.exposure = {};
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::encode_frame_test
