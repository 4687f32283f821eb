#include "shaders/box_sum/box_sum.h"

#include <gtest/gtest.h>

#include "tests/harness.h"

namespace xrds {
namespace {

using test::view;

TEST(BoxSum, MatchesReference) {
  for (const auto& [height, width, scale] : {std::array{1u, 37u, 2u}, std::array{9u, 5u, 4u}})
    test::expectMatchesReference(BoxSum{.input = view(0, DataType::f32, height * scale, width * scale, 8),
                                        .output = view(1, DataType::f32, height, width, 8),
                                        .scale = scale});
}

}  // namespace
}  // namespace xrds
