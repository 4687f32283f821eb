#include "frames/frame_input.h"

#include <gtest/gtest.h>

namespace xrds {
namespace {

// Rows of 3 pixels of 4 floats: 10 y + x, and a fourth float that is not the image's.
constexpr float kPixels[2][12] = {{0, 0, 0, -1, 1, 1, 1, -1, 2, 2, 2, -1},
                                  {10, 10, 10, -1, 11, 11, 11, -1, 12, 12, 12, -1}};
constexpr PixelView kImage{kPixels[0], 3, 2, 4};

TEST(FrameInput, CopiesPartOfARow) {
  std::vector<float> row(6, 7);
  copyRow(kImage, 1, 1, 2, row.data(), 3);
  EXPECT_EQ(row, (std::vector<float>{11, 11, 11, 12, 12, 12}));
}

TEST(FrameInput, ColumnsAreCyclic) {
  std::vector<float> row(8 * 3, 7);
  copyRow(kImage, -4, 0, 8, row.data(), 3);
  for (size_t x = 0; x < 8; ++x) EXPECT_EQ(row[3 * x], kPixels[0][(x + 2) % 3 * 4]) << x;
}

TEST(FrameInput, LeavesWhatIsBetweenItsPixels) {
  std::vector<float> row(10, 7);
  copyRow(kImage, 0, 0, 2, row.data(), 5);
  EXPECT_EQ(row, (std::vector<float>{0, 0, 0, 7, 7, 1, 1, 1, 7, 7}));
}

}  // namespace
}  // namespace xrds
