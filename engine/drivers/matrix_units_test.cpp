#include "engine/drivers/matrix_units.h"

#include <gtest/gtest.h>

namespace xrds {
namespace {

SubgroupControl controlOf(bool full, bool sizes, uint32_t least, uint32_t most, VkShaderStageFlags stages) {
  VkPhysicalDeviceSubgroupSizeControlFeatures features{};
  features.computeFullSubgroups = full;
  features.subgroupSizeControl = sizes;
  VkPhysicalDeviceSubgroupSizeControlProperties properties{};
  properties.minSubgroupSize = least;
  properties.maxSubgroupSize = most;
  properties.requiredSubgroupSizeStages = stages;
  return subgroupControl(features, properties);
}

TEST(SubgroupControl, IsOfThePipelineAmongSeveralSizes) {
  const SubgroupControl control = controlOf(true, true, 32, 64, VK_SHADER_STAGE_COMPUTE_BIT);
  EXPECT_TRUE(control.areKnown);
  EXPECT_TRUE(control.areChosen);
}

TEST(SubgroupControl, IsOfADeviceWithOneSize) {
  for (const VkShaderStageFlags stages : {VkShaderStageFlags{0}, VkShaderStageFlags{VK_SHADER_STAGE_COMPUTE_BIT}})
    for (const bool sizes : {false, true}) {
      const SubgroupControl control = controlOf(true, sizes, 32, 32, stages);
      EXPECT_TRUE(control.areKnown);
      EXPECT_FALSE(control.areChosen);
    }
}

TEST(SubgroupControl, IsNoneOfSizesThatTheDriverChooses) {
  EXPECT_FALSE(controlOf(true, true, 8, 32, 0).areKnown);
  EXPECT_FALSE(controlOf(true, false, 8, 32, VK_SHADER_STAGE_COMPUTE_BIT).areKnown);
  EXPECT_FALSE(controlOf(false, true, 32, 32, VK_SHADER_STAGE_COMPUTE_BIT).areKnown);
}

TEST(MatrixUnits, NeedRegistersForTheirFragments) {
  EXPECT_TRUE(holdsFragments({.least = 32, .most = 32}, 256)) << "NVIDIA";
  EXPECT_TRUE(holdsFragments({.least = 16, .most = 32}, 128)) << "Intel, Battlemage";
  EXPECT_FALSE(holdsFragments({.least = 8, .most = 32}, 128)) << "Intel, Alchemist";
}

}  // namespace
}  // namespace xrds
