#pragma once

#include <array>

namespace xrds {

/// Where the panel stands on a display.
enum class PanelPlace {
  hidden,
  beside,  // the picture has the rest of the display
  folded,  // to a button, because little would be left of the display
  over     // the picture: unfolded on such a display
};

inline constexpr float kPanelWidth = 304;  // as all lengths here in pixels of an ordinary display

/// `wanted`: the panel is switched on; `unfolded`: on a small display, too.
PanelPlace panelPlace(bool wanted, bool unfolded, float displayWidth);

/// A rectangle from its top left corner.
struct Area {
  float x = 0, y = 0, width = 0, height = 0;
};

/// Puts what is said of the left and of the right side of a picture into its lower corners, `rim` away from the edges
/// and each other: side by side, or where that is too wide the left above the right. What is wider than the picture's
/// area is as wide as it allows. Only width and height of the given areas count; an empty one takes no place.
std::array<Area, 2> placeInCorners(float areaWidth, float areaHeight, Area left, Area right, float rim);

}  // namespace xrds
