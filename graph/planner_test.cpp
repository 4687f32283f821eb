#include "graph/planner.h"

#include <gtest/gtest.h>

#include <random>

namespace xrds {
namespace {

bool overlap(uint64_t a, uint64_t aSize, uint64_t b, uint64_t bSize) { return a < b + bSize && b < a + aSize; }

void expectSound(const std::vector<Lifetime>& lives, const MemoryPlan& plan) {
  ASSERT_EQ(plan.offsets.size(), lives.size());
  for (size_t i = 0; i < lives.size(); ++i) {
    EXPECT_EQ(plan.offsets[i] % lives[i].alignment, 0u);
    EXPECT_LE(plan.offsets[i] + lives[i].byteSize, plan.byteSize);
    for (size_t j = 0; j < i; ++j)
      if (lives[i].byteSize > 0 && lives[j].byteSize > 0 && lives[i].firstUse <= lives[j].lastUse &&
          lives[j].firstUse <= lives[i].lastUse) {
        EXPECT_FALSE(overlap(plan.offsets[i], lives[i].byteSize, plan.offsets[j], lives[j].byteSize)) << i << " " << j;
      }
  }
}

TEST(Planner, ReusesBytesOfTheDead) {
  const std::vector<Lifetime> lives{{0, 1, 1000, 256}, {1, 2, 500, 256}, {2, 3, 1000, 256}};
  const MemoryPlan plan = planMemory(lives);
  EXPECT_EQ(plan.offsets[0], plan.offsets[2]);
  EXPECT_EQ(plan.byteSize, 1512u);  // the 500 bytes and their padding, then the 1000
  EXPECT_EQ(planWithoutAliasing(lives).byteSize, 1024u + 512u + 1000u);
  EXPECT_EQ(largestLiveSet(lives), 1500u);
}

TEST(Planner, HandlesNothingAndZeroBytes) {
  EXPECT_EQ(planMemory({}).byteSize, 0u);
  const std::vector<Lifetime> lives{{0, 5, 0, 256}, {0, 5, 10, 256}};
  EXPECT_EQ(planMemory(lives).byteSize, 10u);
}

TEST(Planner, IsSoundOnRandomLifetimes) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Lifetime> lives(1 + random() % 60);
    for (Lifetime& life : lives) {
      life.firstUse = random() % 40;
      life.lastUse = life.firstUse + random() % 10;
      life.byteSize = random() % 5 == 0 ? 0 : 1 + random() % 100000;
      life.alignment = random() % 2 ? 256 : 64;
    }
    const MemoryPlan plan = planMemory(lives);
    expectSound(lives, plan);
    expectSound(lives, planWithoutAliasing(lives));
    EXPECT_GE(plan.byteSize, largestLiveSet(lives));
    EXPECT_EQ(plan.offsets, planMemory(lives).offsets);
  }
}

}  // namespace
}  // namespace xrds
