#include "engine/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace xrds {
namespace {

TEST(InParallel, TakesEachElementOnce) {
  for (const uint64_t count : {0u, 1u, 2u, 7u, 1000u})
    for (const uint64_t least : {0u, 1u, 3u, 5000u}) {
      std::vector<int> taken(count);
      inParallel(count, least, [&](uint64_t begin, uint64_t end) {
        for (; begin < end; ++begin) ++taken[begin];
      });
      EXPECT_EQ(taken, std::vector<int>(count, 1)) << count << " in parts of " << least;
    }
}

TEST(InParallel, PartsHaveTheLeastSize) {
  std::atomic<int> parts = 0;
  inParallel(100, 60, [&](uint64_t begin, uint64_t end) {
    EXPECT_EQ(begin, 0u);
    EXPECT_EQ(end, 100u);
    ++parts;
  });
  EXPECT_EQ(parts, 1);
}

TEST(InParallel, CallsNothingForNothing) {
  inParallel(0, 1, [](uint64_t, uint64_t) { FAIL(); });
}

TEST(InParallel, ThrowsWhatAPartThrows) {
  std::atomic<uint64_t> taken = 0;
  const auto work = [&](uint64_t begin, uint64_t end) {
    taken += end - begin;
    if (end == 64) throw std::runtime_error("the last part");
  };
  EXPECT_THROW(inParallel(64, 1, work), std::runtime_error);
  EXPECT_EQ(taken, 64u);
}

}  // namespace
}  // namespace xrds
