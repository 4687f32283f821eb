#include "engine/pipelines/shared_loads.h"

#include <gtest/gtest.h>

namespace xrds {
namespace {

uint32_t instruction(uint32_t words, uint32_t operation) { return words << 16 | operation; }

TEST(SharedLoads, AreVolatileAndOthersStay) {
  const std::vector<uint32_t> header{0x07230203, 0x00010500, 0, 20, 0};
  const auto moduleOf = [&](std::vector<uint32_t> loads) {
    std::vector<uint32_t> module = header;
    for (const uint32_t word : {instruction(4, 59), 2u, 10u, 4u,       // %10: shared
                                instruction(4, 59), 2u, 11u, 12u,      // %11: a storage buffer
                                instruction(5, 65), 3u, 12u, 10u, 7u,  // a part of each
                                instruction(5, 66), 3u, 13u, 12u, 7u,  // a part of that part
                                instruction(5, 65), 3u, 14u, 11u, 7u})
      module.push_back(word);
    module.insert(module.end(), loads.begin(), loads.end());
    return module;
  };
  EXPECT_EQ(withVolatileSharedLoads(moduleOf({instruction(4, 61), 1,  15, 10,           //
                                              instruction(4, 61), 1,  16, 12,           //
                                              instruction(6, 61), 1,  17, 13, 0x2, 16,  // aligned
                                              instruction(4, 61), 1,  18, 14,           //
                                              instruction(3, 62), 12, 18})),            // a store
            moduleOf({instruction(5, 61), 1,  15, 10, 0x1,                              //
                      instruction(5, 61), 1,  16, 12, 0x1,                              //
                      instruction(6, 61), 1,  17, 13, 0x3, 16,                          //
                      instruction(4, 61), 1,  18, 14,                                   //
                      instruction(3, 62), 12, 18}));
}

}  // namespace
}  // namespace xrds
