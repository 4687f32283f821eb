// Workgroups in one row may be more than the 65535 a dimension allows: they are folded into rows.
#ifndef XRDS_SHADERS_COMMON_GROUPS_H
#define XRDS_SHADERS_COMMON_GROUPS_H

#ifdef __cplusplus
#include "engine/dispatch.h"
namespace xrds {
inline constexpr uint32_t kMaxGroupCount = 65535;

/// At least `count` workgroups as a grid that any device takes; those beyond find nothing to do.
inline std::array<uint32_t, 3> foldedGroups(uint64_t count) {
  const uint32_t rows = ceilDivide(count, kMaxGroupCount);
  return {ceilDivide(count, rows), rows, 1};
}
}  // namespace xrds
#else
uint foldedGroup() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }
#endif
#endif
