// Merging in bands of rows, whose images move about in their memory: no bit may depend on it.
#include "frames/history_merger.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/harness.h"

namespace xrds {
namespace {

constexpr uint32_t kHeight = 11, kWidth = 9, kScale = 2;
constexpr size_t kLow = size_t{kHeight} * kWidth, kFull = kScale * kScale * kLow;

// Radiance, counts and guides that differ little from frame to frame, and motion of a few pixels.
struct Pixels {
  std::vector<float> low, full, toPrevious, toNext;

  HistoryFrame rows() const {
    const auto of = [](const std::vector<float>& pixels) {
      return
          [&pixels](uint32_t y, std::span<float> row) { std::copy_n(&pixels[y * row.size()], row.size(), row.data()); };
    };
    return {of(low), of(full), of(toPrevious), of(toNext)};
  }
};

Pixels frameOf(uint32_t number) {
  const auto pixels = [&](size_t count) {
    const std::vector<float> common = test::randomNumbers(count * shader::kHistoryFrame, 1),
                             own = test::randomNumbers(count * shader::kHistoryFrame, 10 + number);
    std::vector<float> values(common.size());
    for (size_t i = 0; i < values.size(); ++i) {
      values[i] = std::abs(common[i] + 0.05F * own[i]);
      if (i % 12 == 3) values[i] = 1;
    }
    return values;
  };
  return {pixels(kLow), pixels(kFull), test::randomNumbers(4 * kFull, 20 + number),
          test::randomNumbers(4 * kFull, 30 + number)};
}

struct Merged {
  std::vector<float> low = std::vector<float>(4 * kLow), full = std::vector<float>(shader::kHistoryFrame * kFull);
  bool operator==(const Merged&) const = default;
};

Merged merged(HistoryMerger& merger, const std::vector<Pixels>& frames, size_t past, size_t future) {
  std::vector<HistoryFrame> before, after;
  for (size_t i = 0; i < past; ++i) before.push_back(frames[1 + i].rows());
  for (size_t i = 0; i < future; ++i) after.push_back(frames[4 + i].rows());
  Merged result;
  const auto into = [](std::vector<float>& values) {
    return [&values](uint32_t y, std::span<const float> row) {
      std::copy(row.begin(), row.end(), &values[y * row.size()]);
    };
  };
  merger.run(frames[0].rows(), before, after, into(result.low), into(result.full));
  return result;
}

TEST(HistoryMerger, BandsNeverChangeABit) {
  std::vector<Pixels> frames;
  for (uint32_t number = 0; number < 7; ++number) frames.push_back(frameOf(number));
  HistoryMerger whole(test::gpu(), kHeight, kWidth, kScale, 1000);
  for (const uint32_t rows : {1U, 3U, 8U, 21U}) {
    HistoryMerger banded(test::gpu(), kHeight, kWidth, kScale, rows);
    EXPECT_LT(banded.deviceBytes(), whole.deviceBytes());
    // Of odd and even numbers, so that the sums end in either place.
    for (const auto& [past, future] : {std::pair<size_t, size_t>{3, 3}, {2, 3}, {0, 1}, {3, 0}}) {
      const Merged expected = merged(whole, frames, past, future);
      EXPECT_TRUE(merged(banded, frames, past, future) == expected) << rows << ": " << past << " " << future;
      EXPECT_TRUE(std::isfinite(expected.full[0]));
    }
  }
}

// Two images of twelve floats and one of sums, positions, and a little for bands and what is of the low resolution.
TEST(HistoryMerger, HoldsNoImageTwice) {
  HistoryMerger merger(test::gpu(), 120, 40, 4);
  EXPECT_LT(merger.deviceBytes(), 210U * 480 * 160);
}

}  // namespace
}  // namespace xrds
