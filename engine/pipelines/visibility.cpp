#include "engine/pipelines/visibility.h"

#include <map>
#include <utility>

namespace xrds {
namespace {

constexpr uint32_t kBoundWord = 3;  // of the header
// Of instructions.
constexpr uint32_t kMemoryModel = 14, kConstant = 43, kLoad = 61, kStore = 62, kControlBarrier = 224;
constexpr uint32_t kMatrixLoadNv = 5359, kMatrixStoreNv = 5360, kMatrixLoad = 4457, kMatrixStore = 4458;
constexpr uint32_t kVulkanModel = 3, kScopeWorkgroup = 2;
// Of memory operands; those before MakePointerAvailable that have a number behind them: Aligned.
constexpr uint32_t kAligned = 2, kMakePointerAvailable = 8, kMakePointerVisible = 16;
// Of memory semantics.
constexpr uint32_t kAcquireRelease = 8, kWorkgroupMemory = 0x100, kMakeAvailableAndVisible = 0x2000 | 0x4000;

// The word of an instruction that holds its memory operands; 0: it has none.
uint32_t memoryOperands(SpirvWords instruction) {
  static const std::map<uint32_t, uint32_t> kPlaces{{kLoad, 4},          {kStore, 3},      {kMatrixLoadNv, 6},
                                                    {kMatrixStoreNv, 5}, {kMatrixLoad, 6}, {kMatrixStore, 5}};
  const auto found = kPlaces.find(operationOf(instruction));
  return found == kPlaces.end() || found->second >= instruction.size() ? 0 : found->second;
}

class Rewriting {
 public:
  explicit Rewriting(SpirvWords module) : module_(module), made_(module.begin(), module.begin() + kSpirvHeaderWords) {
    forEachInstruction(module, [&](SpirvWords instruction) {
      if (operationOf(instruction) == kConstant && instruction.size() == 4) constants_[instruction[2]] = instruction[3];
      if (operationOf(instruction) == kControlBarrier) semantics_[instruction[3]] = 0;
    });
  }

  std::vector<uint32_t> rewritten() {
    forEachInstruction(module_, [&](SpirvWords instruction) {
      if (operationOf(instruction) == kControlBarrier)
        addBarrier(instruction);
      else if (const uint32_t place = memoryOperands(instruction))
        addAccess(instruction, place);
      else
        made_.insert(made_.end(), instruction.begin(), instruction.end());
      if (operationOf(instruction) == kConstant) addStronger(instruction);
    });
    return std::move(made_);
  }

 private:
  // Behind the constant of a barrier's semantics, the one that takes its place.
  void addStronger(SpirvWords constant) {
    const auto barrier = semantics_.find(constant[2]);
    constexpr uint32_t kNeeded = kAcquireRelease | kWorkgroupMemory;
    if (barrier == semantics_.end() || constant.size() != 4 || (constant[3] & kNeeded) != kNeeded) return;
    barrier->second = made_[kBoundWord]++;
    for (const uint32_t word : {constant[0], constant[1], barrier->second, constant[3] | kMakeAvailableAndVisible})
      made_.push_back(word);
  }

  void addBarrier(SpirvWords barrier) {
    made_.insert(made_.end(), barrier.begin(), barrier.end());
    if (const uint32_t stronger = semantics_[barrier[3]]) made_.back() = stronger;
  }

  void addAccess(SpirvWords access, uint32_t place) {
    const uint32_t mask = access[place], asked = mask & (kMakePointerAvailable | kMakePointerVisible);
    const uint32_t scope = place + 1 + (mask & kAligned ? 1 : 0);
    const bool isOfWorkgroup = asked != 0 && scope < access.size() && constants_[access[scope]] == kScopeWorkgroup;
    for (uint32_t i = 0; i < access.size(); ++i) {
      if (isOfWorkgroup && i == scope) continue;
      made_.push_back(access[i]);
      if (isOfWorkgroup && i == 0) made_.back() -= 1u << 16;  // a word less
      if (isOfWorkgroup && i == place) made_.back() &= ~asked;
    }
  }

  SpirvWords module_;
  std::vector<uint32_t> made_;
  std::map<uint32_t, uint32_t> constants_;  // values by name
  std::map<uint32_t, uint32_t> semantics_;  // of barriers, and the constants that take their places
};

}  // namespace

std::vector<uint32_t> visibleAtBarriers(SpirvWords module) {
  bool isInVulkanModel = false;
  forEachInstruction(module, [&](SpirvWords instruction) {
    isInVulkanModel |= operationOf(instruction) == kMemoryModel && instruction[2] == kVulkanModel;
  });
  if (!isInVulkanModel) return {module.begin(), module.end()};
  return Rewriting(module).rewritten();
}

}  // namespace xrds
