// The harness itself: what it must let pass and what it must not.
#include "tests/harness.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include "tests/engine_programs.h"

namespace xrds {
namespace {

using test::view;

// y = 2 x + 1 by the program twice_plus; each field that is not its default breaks one promise.
struct TwicePlusOne {
  TensorView input = view(0, DataType::f32, 3, 5, 8), output = view(1, DataType::f32, 3, 5, 8);
  uint32_t add = 1;        // another number: a wrong result
  uint32_t lessQuads = 0;  // that many vec4 at the end stay as they were
  RowRange rows{};
};

Dispatch dispatch(const TwicePlusOne& op, const DeviceTraits&) {
  const auto quads = static_cast<uint32_t>(op.output.storedByteSize() / 16) - op.lessQuads;
  Dispatch result;
  result.program = "twice_plus";
  result.specialization = {op.add};
  result.bindings = {readTexels(op.input), writeRows(op.output, {0, op.output.height})};
  result.pushConstants = pushBytes(quads);
  result.groupCount = {ceilDivide(quads, 64), 1, 1};
  return result;
}

void reference(const TwicePlusOne& op, HostMemory& memory) {
  const RowRange rows = resolve(op.rows, op.output.height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < op.output.width; ++x)
      for (uint32_t c = 0; c < op.output.channels; ++c)
        memory.at(op.output, y, x, c) = 2 * memory.at(op.input, y, x, c) + 1;
}

TEST(Harness, AcceptsARightKernel) { test::expectMatchesReference(TwicePlusOne{}); }

TEST(Harness, AcceptsAKernelInPlace) {
  TwicePlusOne op;
  op.output = op.input;
  test::expectMatchesReference(op);
}

TEST(Harness, TakesGivenContents) {
  TwicePlusOne op{.input = view(0, DataType::f16, 1, 1, 4), .output = view(1, DataType::f32, 1, 1, 4)};
  test::expectMatchesReference(op, {{0, {1, 2, 3, 0.1f}}});
}

TEST(Harness, RefusesContentsOfAnotherSize) {
  EXPECT_THROW(test::expectMatchesReference(TwicePlusOne{}, {{0, {1, 2, 3}}}), std::logic_error);
}

// Failures are caught here; there may be several, of which one has the text.
std::string failuresOf(const TwicePlusOne& op) {
  testing::TestPartResultArray failures;
  {
    const testing::ScopedFakeTestPartResultReporter reporter(
        testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &failures);
    test::expectMatchesReference(op);
  }
  std::string text;
  for (int i = 0; i < failures.size(); ++i) text += failures.GetTestPartResult(i).message();
  return text;
}

TEST(Harness, NoticesAWrongResult) { EXPECT_NE(failuresOf({.add = 2}).find("differenceRms"), std::string::npos); }

TEST(Harness, NoticesWhatWasNotWritten) {
  EXPECT_NE(failuresOf({.lessQuads = 1}).find("notFinite"), std::string::npos);
}

TEST(Harness, NoticesWritesOutsideTheSlice) {
  TwicePlusOne op;
  op.output = slice(op.output, 4, 4);
  op.input = slice(op.input, 4, 4);
  EXPECT_NE(failuresOf(op).find("changed bytes outside"), std::string::npos);
}

TEST(Harness, NoticesWritesOutsideTheRows) {
  EXPECT_NE(failuresOf({.rows = {1, 2}}).find("changed bytes outside"), std::string::npos);
}

}  // namespace
}  // namespace xrds
