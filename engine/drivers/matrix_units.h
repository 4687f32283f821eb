#pragma once

#include <utility>

#include "engine/device.h"
#include "engine/drivers/instance.h"

namespace xrds {

/// What a device says of the subgroups of a pipeline.
struct SubgroupControl {
  bool areKnown = false;         // how many invocations they have, and that all of them are full
  bool areChosen = false;        // by the pipeline; else the device has one size
  uint32_t least = 0, most = 0;  // invocations, a power of two
  uint32_t mostOfGroup = 0;      // subgroups of a workgroup whose pipeline has chosen
};
SubgroupControl subgroupControl(VkPhysicalDevice device);
SubgroupControl subgroupControl(const VkPhysicalDeviceSubgroupSizeControlFeatures& features,
                                const VkPhysicalDeviceSubgroupSizeControlProperties& sizes);

/// The way to the matrix units of a device whose subgroups are known: the first extension with which one
/// multiplies matrices of 16-bit floats and adds up in 32 bits, and the largest product that fragments of 16 x 16 are
/// made of.
std::pair<MatrixUnits, MatrixSize> findMatrixUnits(const Instance& instance, VkPhysicalDevice device);

/// Whether a subgroup of a device with so many registers an invocation (registersOf()) has room for the fragments of a
/// kernel. The matrix kernels spill hundreds of registers on the first GPUs of Intel with matrix units (Alchemist),
/// whose subgroups of 8 have 4 KiB.
bool holdsFragments(const SubgroupControl& subgroups, uint32_t registers);

/// The device extensions that the units need, "VK_NV_cooperative_matrix", say; and the control of subgroups, which
/// pipelines may use without units, too.
std::vector<const char*> extensionsOf(MatrixUnits units, bool choosesSubgroups = false);

/// What these extensions need of a device. enable() adds it to the features with which one is opened, which then point
/// here.
struct MatrixFeatures {
  VkPhysicalDeviceSubgroupSizeControlFeatures subgroups{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_FEATURES};
  VkPhysicalDeviceCooperativeMatrixFeaturesNV nv{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_COOPERATIVE_MATRIX_FEATURES_NV};
#ifdef VK_KHR_cooperative_matrix
  VkPhysicalDeviceCooperativeMatrixFeaturesKHR khr{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_COOPERATIVE_MATRIX_FEATURES_KHR};
#endif
  void enable(MatrixUnits units, bool choosesSubgroups, VkPhysicalDeviceVulkan12Features& features);
};

}  // namespace xrds
