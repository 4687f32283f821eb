#include "engine/pipelines/shared_loads.h"

#include <set>

namespace xrds {
namespace {

// Of instructions.
constexpr uint32_t kVariable = 59, kLoad = 61, kAccessChain = 65, kInBoundsAccessChain = 66;
constexpr uint32_t kWorkgroupStorage = 4;
constexpr uint32_t kVolatile = 1;  // of memory operands

}  // namespace

std::vector<uint32_t> withVolatileSharedLoads(SpirvWords module) {
  std::vector<uint32_t> made(module.begin(), module.begin() + kSpirvHeaderWords);
  std::set<uint32_t> shared;  // names of pointers
  forEachInstruction(module, [&](SpirvWords instruction) {
    const uint32_t operation = operationOf(instruction);
    const size_t first = made.size();
    made.insert(made.end(), instruction.begin(), instruction.end());
    if (operation == kVariable && instruction[3] == kWorkgroupStorage) shared.insert(instruction[2]);
    if ((operation == kAccessChain || operation == kInBoundsAccessChain) && shared.contains(instruction[3]))
      shared.insert(instruction[2]);
    if (operation != kLoad || !shared.contains(instruction[3])) return;
    if (instruction.size() > 4) {
      made[first + 4] |= kVolatile;
    } else {
      made.push_back(kVolatile);
      made[first] += 1u << 16;  // a word more
    }
  });
  return made;
}

}  // namespace xrds
