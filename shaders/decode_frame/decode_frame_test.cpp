#include "shaders/decode_frame/decode_frame.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::decode_frame_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, paddedHeight, paddedWidth;
  RowRange rows{};
};

constexpr Shape kShapes[] = {{1, 1, 16, 16}, {9, 13, 16, 16}, {16, 16, 16, 16, {3, 6}}, {17, 33, 32, 48, {8, 17}}};

DecodeFrame decodeOf(const Shape& s, FrameCurve curve, DataType inputType = DataType::f32) {
  DecodeFrame op{.input = view(0, inputType, s.paddedHeight, s.paddedWidth, 4, 4, 12),
                 .output = view(2, DataType::f32, s.height, s.width, 4),
                 .curve = curve,
                 .rows = s.rows};
  if (curve == FrameCurve::hdr) op.exposure = view(1, DataType::f32, 1, 1, 4);
  return op;
}

class DecodeFrameShapes : public testing::TestWithParam<std::tuple<Shape, KernelFamily, FrameCurve, DataType>> {};

// From 0 to 1.5; what is below 0 counts as 0.
TEST_P(DecodeFrameShapes, MatchesReference) {
  const auto& [s, family, curve, inputType] = GetParam();
  const DecodeFrame op = decodeOf(s, curve, inputType);
  std::vector<float> pixels = test::randomNumbers(op.input.storedElementCount(), 7);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = i % 12 == 6 ? -pixels[i] : 1.5f * std::abs(pixels[i]);
  test::expectMatchesReference(op, test::traitsOf(family), {1e-5, 1e-4}, {{0, pixels}, {1, {0.5f, 2, 0, 0}}});
}

INSTANTIATE_TEST_SUITE_P(All, DecodeFrameShapes,
                         testing::Combine(testing::ValuesIn(kShapes),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane),
                                          testing::Values(FrameCurve::hdr, FrameCurve::ldr, FrameCurve::normal),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(DecodeFrame, MarksWhatIsNotFinite) {
  const DecodeFrame op = decodeOf({16, 16, 16, 16}, FrameCurve::ldr);
  std::vector<float> pixels(op.input.storedElementCount(), 0.25f);
  pixels[12 * 5 + 4] = std::numeric_limits<float>::quiet_NaN();
  pixels[12 * 9 + 6] = std::numeric_limits<float>::infinity();
  test::expectMatchesReference(op, test::traitsOf(KernelFamily::plain), {1e-5, 1e-4}, {{0, pixels}});
}

TEST(DecodeFrame, RefusesWhatDoesNotFit) {
  DecodeFrame op = decodeOf({9, 9, 8, 16}, FrameCurve::ldr);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = decodeOf({8, 8, 8, 8}, FrameCurve::hdr);
  op.exposure = {};
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::decode_frame_test
