#include "engine/pipelines/visibility.h"

#include <gtest/gtest.h>

namespace xrds {
namespace {

uint32_t instruction(uint32_t words, uint32_t operation) { return words << 16 | operation; }

// A module of a load of shared memory between barriers, a store, and an access of the device's scope.
std::vector<uint32_t> moduleIn(uint32_t memoryModel) {
  return {0x07230203,           0x00010500, 0,           20,    0,         // the bound is 20
          instruction(3, 14),   0,          memoryModel,                   //
          instruction(4, 43),   1,          10,          2,                // %10 = workgroup
          instruction(4, 43),   1,          11,          0x108,            // %11 = acquire, release, workgroup memory
          instruction(4, 43),   1,          12,          1,                // %12 = device
          instruction(4, 224),  10,         10,          11,               //
          instruction(6, 61),   2,          13,          14,    0x30, 10,  // visible, non-private
          instruction(7, 61),   2,          15,          14,    0x32, 4,    10,        // aligned, too
          instruction(5, 62),   14,         13,          0x28,  10,                    // available, non-private
          instruction(6, 61),   2,          16,          17,    0x30, 12,              // of the device: stays
          instruction(8, 4457), 3,          18,          14,    5,    6,    0x30, 10,  //
          instruction(7, 4458), 14,         18,          5,     6,    0x28, 10,        //
          instruction(4, 61),   2,          19,          17};
}

TEST(Visibility, IsWhatBarriersBring) {
  const std::vector<uint32_t> expected{0x07230203,           0x00010500, 0,  21,     0,     //
                                       instruction(3, 14),   0,          3,                 //
                                       instruction(4, 43),   1,          10, 2,             //
                                       instruction(4, 43),   1,          11, 0x108,         //
                                       instruction(4, 43),   1,          20, 0x6108,        // and available and visible
                                       instruction(4, 43),   1,          12, 1,             //
                                       instruction(4, 224),  10,         10, 20,            //
                                       instruction(5, 61),   2,          13, 14,     0x20,  //
                                       instruction(6, 61),   2,          15, 14,     0x22, 4,           //
                                       instruction(4, 62),   14,         13, 0x20,                      //
                                       instruction(6, 61),   2,          16, 17,     0x30, 12,          //
                                       instruction(7, 4457), 3,          18, 14,     5,    6,    0x20,  //
                                       instruction(6, 4458), 14,         18, 5,      6,    0x20,        //
                                       instruction(4, 61),   2,          19, 17};
  EXPECT_EQ(visibleAtBarriers(moduleIn(3)), expected);
}

TEST(Visibility, OfOtherMemoryModelsStays) { EXPECT_EQ(visibleAtBarriers(moduleIn(1)), moduleIn(1)); }

}  // namespace
}  // namespace xrds
