#include "viewer/display/layout.h"

#include <algorithm>

namespace xrds {

PanelPlace panelPlace(bool wanted, bool unfolded, float displayWidth) {
  constexpr float kLeastBeside = 2.1F * kPanelWidth;
  if (!wanted) return PanelPlace::hidden;
  if (displayWidth >= kLeastBeside) return PanelPlace::beside;
  return unfolded ? PanelPlace::over : PanelPlace::folded;
}

std::array<Area, 2> placeInCorners(float areaWidth, float areaHeight, Area left, Area right, float rim) {
  for (Area* area : {&left, &right}) {
    area->width = std::clamp(area->width, 0.F, std::max(0.F, areaWidth - 2 * rim));
    area->y = areaHeight - rim - area->height;
  }
  left.x = rim;
  right.x = areaWidth - rim - right.width;
  const bool both = left.height > 0 && right.height > 0;
  if (both && left.x + left.width + rim > right.x) left.y = right.y - rim / 2 - left.height;
  return {left, right};
}

}  // namespace xrds
