#include "engine/hazards.h"

#include <gtest/gtest.h>

#include <random>

namespace xrds {
namespace {

using Accesses = std::vector<std::vector<RangeAccess>>;

RangeAccess reads(uint64_t begin, uint64_t size, uint64_t buffer = 0) { return {buffer, begin, size, Access::read}; }
RangeAccess writes(uint64_t begin, uint64_t size, uint64_t buffer = 0) { return {buffer, begin, size, Access::write}; }

std::vector<bool> of(const Accesses& accesses) { return barriersBefore(accesses); }

TEST(Hazards, ReadAfterWriteNeedsABarrier) {
  EXPECT_EQ(of({{writes(0, 16)}, {reads(0, 16)}}), (std::vector{false, true}));
}

TEST(Hazards, WriteAfterReadNeedsABarrier) {
  EXPECT_EQ(of({{reads(0, 16)}, {writes(0, 16)}}), (std::vector{false, true}));
}

TEST(Hazards, WriteAfterWriteNeedsABarrier) {
  EXPECT_EQ(of({{writes(0, 16)}, {writes(0, 16)}}), (std::vector{false, true}));
}

TEST(Hazards, ReadsShareWithoutABarrier) {
  EXPECT_EQ(of({{reads(0, 16)}, {reads(8, 16)}}), (std::vector{false, false}));
}

TEST(Hazards, TouchingRangesDoNotConflict) {
  EXPECT_EQ(of({{writes(0, 16)}, {reads(16, 16)}, {writes(32, 1)}}), (std::vector{false, false, false}));
}

TEST(Hazards, OneSharedByteConflicts) { EXPECT_EQ(of({{writes(0, 17)}, {reads(16, 16)}}), (std::vector{false, true})); }

TEST(Hazards, OtherBuffersDoNotConflict) {
  EXPECT_EQ(of({{writes(0, 16, 1)}, {reads(0, 16, 2)}}), (std::vector{false, false}));
}

TEST(Hazards, OneBarrierCoversAllBeforeIt) {
  EXPECT_EQ(of({{writes(0, 16)}, {writes(16, 16)}, {reads(0, 16)}, {reads(16, 16)}}),
            (std::vector{false, false, true, false}));
}

TEST(Hazards, ConflictReachesBackOverOtherDispatches) {
  EXPECT_EQ(of({{writes(0, 16)}, {writes(64, 16)}, {writes(128, 16)}, {reads(0, 4)}}),
            (std::vector{false, false, false, true}));
}

TEST(Hazards, InPlaceDispatchDoesNotConflictWithItself) {
  EXPECT_EQ(of({{reads(0, 16), writes(0, 16)}, {reads(0, 16), writes(0, 16)}}), (std::vector{false, true}));
}

TEST(Hazards, NothingNeedsNoBarrier) {
  EXPECT_TRUE(of({}).empty());
  EXPECT_EQ(of({{}, {}}), (std::vector{false, false}));
}

// Byte by byte: does dispatch b have to wait for dispatch a?
bool mustWait(const std::vector<RangeAccess>& a, const std::vector<RangeAccess>& b) {
  for (const auto& x : a)
    for (const auto& y : b)
      for (uint64_t byte = x.byteOffset; byte < x.byteOffset + x.byteSize; ++byte)
        if (x.buffer == y.buffer && byte >= y.byteOffset && byte < y.byteOffset + y.byteSize &&
            (x.access == Access::write || y.access == Access::write))
          return true;
  return false;
}

TEST(Hazards, MatchesBruteForceOnRandomLists) {
  std::mt19937 bits(1);
  const auto below = [&bits](uint32_t count) { return bits() % count; };
  for (int round = 0; round < 400; ++round) {
    Accesses accesses(1 + below(20));
    for (auto& dispatch : accesses)
      for (uint32_t i = below(4); i-- > 0;)
        dispatch.push_back({below(2), below(40), 1 + below(8), below(3) ? Access::read : Access::write});
    const auto barriers = of(accesses);
    ASSERT_EQ(barriers.size(), accesses.size());
    size_t lastBarrier = 0;
    for (size_t i = 0; i < accesses.size(); ++i) {
      bool needed = false;
      for (size_t j = lastBarrier; j < i; ++j) needed = needed || mustWait(accesses[j], accesses[i]);
      ASSERT_EQ(barriers[i], needed) << "round " << round << " dispatch " << i;
      if (needed) lastBarrier = i;
    }
  }
}

}  // namespace
}  // namespace xrds
